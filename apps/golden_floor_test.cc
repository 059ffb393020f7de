// `touchstone golden floor` as ci/golden-floor runs it: a few cases at a time, into one file that is judged as a whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;

class GoldenFloor : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    testing::BuiltProgram::SetUp();
    if (IsSkipped()) return;
    std::filesystem::create_directories(folder_ / "golden");
    for (const char* const one : {"plane-taps-small-fast", "scene-wall-small-fast"}) {
      std::filesystem::copy(std::filesystem::path(testing::environment("TOUCHSTONE_SOURCE_DIR")) / "golden" / one,
                            folder_ / "golden" / one, std::filesystem::copy_options::recursive);
    }
  }
  [[nodiscard]] Outcome measure(const std::string& one) const {
    return run("golden floor " + one + " --golden golden --json floor.json --program '" + program_ + "'");
  }
  [[nodiscard]] nlohmann::json kept() const { return nlohmann::json::parse(read_file(folder_ / "floor.json")); }
};

TEST_F(GoldenFloor, CasesMeasuredOneAfterAnotherAreOneFile) {
  ASSERT_EQ(measure("plane-taps-small-fast").status, 0);
  const Outcome missing = run("golden floor --golden golden --json floor.json");
  EXPECT_EQ(missing.status, 77);
  EXPECT_THAT(missing.out, HasSubstr("scene-wall-small-fast friction-cone: never measured"));
  ASSERT_EQ(measure("scene-wall-small-fast").status, 0);
  EXPECT_EQ(run("golden floor --golden golden --json floor.json").status, 0);
  std::set<std::string> cases;
  const nlohmann::json file = kept();
  for (const auto& floor : file["floors"]) {
    cases.insert(floor["case"].get<std::string>());
    EXPECT_EQ(floor["commit"], file["programs"][0]["commit"]);
    EXPECT_EQ(floor["of_tolerance"], 0.0) << "the program that made the goldens is as far from them as from itself";
  }
  EXPECT_EQ(cases, (std::set<std::string>{"plane-taps-small-fast", "scene-wall-small-fast"}));
}

TEST_F(GoldenFloor, WhatOtherProgramsMeasuredIsNotMixedIn) {
  ASSERT_EQ(measure("plane-taps-small-fast").status, 0);
  nlohmann::json other = kept();
  other["programs"][0]["flags"] = "-O7";
  write_file(folder_ / "floor.json", other.dump());
  const Outcome refused = measure("scene-wall-small-fast");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("measured with programs of other compilers"));
  EXPECT_EQ(kept(), other);
  // Every case that it has measured again: nothing of the others is left.
  EXPECT_EQ(measure("plane-taps-small-fast").status, 0);
  EXPECT_NE(kept()["programs"][0]["flags"], "-O7");
}

}  // namespace
}  // namespace touchstone::apps
