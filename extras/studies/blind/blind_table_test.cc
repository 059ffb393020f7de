#include "blind/blind_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace touchstone::blind {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

BlindScore missed(double floor_N) {
  BlindScore score;
  score.id = "abc";
  score.set = "outside";
  score.expected = {"backlash"};
  score.after_N = 0.25;
  score.floor_N = floor_N;
  return score;
}

TEST(BlindTable, ACaseThatNoModelIsTrueOfHasNoFloor) {
  const std::vector<BlindScore> scores{missed(std::numeric_limits<double>::quiet_NaN())};
  EXPECT_THAT(blind_table(scores).text, HasSubstr("(held out 0.25 N, no true model)"));
  EXPECT_THAT(blind_table(scores).text, Not(HasSubstr("nan")));
  EXPECT_TRUE(nlohmann::json::parse(blind_json(scores)).at("cases").at(0).at("floor_N").is_null());
}

TEST(BlindTable, AFloorIsGivenWhereThereIsOne) {
  EXPECT_THAT(blind_table({missed(0.125)}).text, HasSubstr("(held out 0.25 N, floor 0.125 N)"));
}

}  // namespace
}  // namespace touchstone::blind
