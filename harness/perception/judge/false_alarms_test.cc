// How often two recordings of one process are called two processes. A small fixed sample; the whole in
// false_alarms_nightly_test.cc.
#include "harness/perception/judge/false_alarms_for_test.h"

namespace touchstone::perception {
namespace {

TEST(FalseAlarms, OneProcessRecordedTwiceIsSeldomTwo) {
  const FalseAlarms alarms = false_alarms({0.005, 0.05}, {250.0, 1000.0}, {{1.0, 1.0}, {0.7, 1.0}}, 3, 3);
  EXPECT_LE(alarms.noticed, alarms.pairs / 20) << alarms.pairs << " pairs";
}

}  // namespace
}  // namespace touchstone::perception
