// All kinds of surface, three noises, three rates, four hands, twelve seeds.
#include "harness/perception/judge/false_alarms_for_test.h"

namespace touchstone::perception {
namespace {

TEST(FalseAlarms, AreFiveOfAHundredAtMost) {
  const FalseAlarms alarms = false_alarms({0.001, 0.005, 0.05}, {250.0, 1000.0, 3000.0},
                                          {{1.0, 1.0}, {0.6, 1.0}, {1.0, 0.7}, {1.2, 1.3}}, 12, 5);
  EXPECT_LE(alarms.noticed, alarms.pairs / 20) << alarms.pairs << " pairs";
}

}  // namespace
}  // namespace touchstone::perception
