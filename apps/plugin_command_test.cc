// --plugin as a user gives it: what the commands do with a right plug-in, and with ones that go wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

using testing::environment;
using testing::Outcome;

class PluginCommand : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    testing::BuiltProgram::SetUp();
    if (IsSkipped()) return;
    write_file(folder_ / "plate.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "plane.json",
               R"({"schema": "touchstone-model/1", "renderer": "plane", "parameters": {"stiffness_N_per_m": 400}})");
    write_file(folder_ / "god-object.json", R"({"schema": "touchstone-model/1", "renderer": "god-object"})");
    std::string taps = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int n = 0; n < 1000; ++n) {
      const double z = 1e-3 * std::cos(0.02 * n);
      taps += fmt::format("{},0.1,0.2,{},0,0,{}\n", 1e-3 * n, z, z < 0.0 ? -700.0 * z : 0.0);
    }
    write_file(folder_ / "taps.csv", taps);
  }
  static std::string plugin(const std::string& name) {
    return "--plugin " + environment("TOUCHSTONE_TEST_PLUGINS") + "/" + name + ".so";
  }
};

TEST_F(PluginCommand, ListShowsItsRenderers) {
  const Outcome list = run("list renderers " + plugin("NOTHING"));
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_THAT(list.out, AllOf(HasSubstr("the plane z = 0, F = k dx (Hooke's law; a plug-in's)"),
                              HasSubstr("stiffness_N_per_m [N/m], 500 where not set"), HasSubstr("god-object")));
}

TEST_F(PluginCommand, ReplayRendersWithIt) {
  for (const char* const mode : {"", " --plugin-in-process"}) {
    const Outcome replay =
        run("replay --model plane.json --mesh plate.obj --trajectory taps.csv --out out.csv --json "
            "out.json " +
            plugin("NOTHING") + mode);
    ASSERT_EQ(replay.status, 0) << replay.err;
    const auto summary = nlohmann::json::parse(read_file(folder_ / "out.json"));
    EXPECT_EQ(summary["samples"], 1000);
    EXPECT_NEAR(summary["largest_force_N"].get<double>(), 0.4, 1e-6);
  }
}

// The plane z = 0 knows no other side, no ball and no triangle: a scorecard says so by name.
TEST_F(PluginCommand, ScorecardNamesItsFaults) {
  const Outcome card = run("scorecard --no-cases --no-cost --out card --plugin-in-process " + plugin("NOTHING"));
  EXPECT_EQ(card.status, 1) << card.err;
  const auto json = nlohmann::json::parse(read_file(folder_ / "card/plane.json"));
  EXPECT_EQ(json["schema"], "touchstone-scorecard/1");
  EXPECT_FALSE(json["findings"].empty());
  EXPECT_THAT(json["clean"].get<std::vector<std::string>>(), ::testing::Contains("delay"));
  EXPECT_THAT(read_file(folder_ / "card/index.html"), HasSubstr("sticks-at-joints"));
  EXPECT_EQ(run("scorecard --out card").status, 2) << "no renderer is named";
}

TEST_F(PluginCommand, FitFindsItsStiffness) {
  const Outcome fit =
      run("fit --parameter stiffness_N_per_m=100:5000 --model plane.json --recording taps.csv --mesh plate.obj "
          "--in-trajectory measured --out fitted " +
          plugin("NOTHING"));
  ASSERT_EQ(fit.status, 0) << fit.err;
  const auto model = nlohmann::json::parse(read_file(folder_ / "fitted/model.json"));
  EXPECT_EQ(model["renderer"], "plane");
  EXPECT_NEAR(model["parameters"]["stiffness_N_per_m"].get<double>(), 700.0, 0.7);
}

TEST_F(PluginCommand, ACrashFailsItsModelOnly) {
  const Outcome evaluate =
      run("evaluate --model plane.json --model god-object.json --recording taps.csv --mesh plate.obj --in-trajectory "
          "measured --metrics rms_force_error --out report --json all.json " +
          plugin("CRASHES_IN_STEP"));
  EXPECT_EQ(evaluate.status, 1);
  EXPECT_THAT(evaluate.out, AllOf(HasSubstr("FAILED: plane"), HasSubstr("crashed (SIGABRT"),
                                  HasSubstr("touchstone_step"), HasSubstr("report: report/god-object/report.html")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report/god-object/report.html"));
  const auto all = nlohmann::json::parse(read_file(folder_ / "all.json"));
  EXPECT_THAT(all["evaluations"][0]["failure"].get<std::string>(), HasSubstr("SIGABRT"));
  EXPECT_FALSE(all["evaluations"][1].contains("failure"));
  EXPECT_FALSE(all["evaluations"][1]["metrics"].empty());
}

TEST_F(PluginCommand, ACrashFailsItsGoldenCaseAndTheOthersRun) {
  const Outcome check =
      run("check plane-taps sphere-scan --model spring-linear --renderer plane --out failures --golden " +
          environment("TOUCHSTONE_SOURCE_DIR") + "/golden " + plugin("CRASHES_IN_STEP"));
  EXPECT_EQ(check.status, 1) << check.err;
  EXPECT_THAT(check.out, AllOf(HasSubstr("plane-taps spring-linear"), HasSubstr("sphere-scan spring-linear"),
                               HasSubstr("crashed (SIGABRT"), HasSubstr("0 passed, 2 failed")));
}

// Without names of cases, those that lack the model say nothing about it, and a summary ends the run.
TEST_F(PluginCommand, CasesWithoutTheModelArePassedOver) {
  const std::string golden = " --out failures --golden " + environment("TOUCHSTONE_SOURCE_DIR") + "/golden";
  const Outcome check = run("check --model force-shading-ball" + golden);
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, AllOf(HasSubstr("0 failed"), HasSubstr("cases without the model force-shading-ball: ")));
  const Outcome none = run("check --model force-shading-cube" + golden);
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("has no model 'force-shading-cube'"));
}

TEST_F(PluginCommand, WhatCannotBeUsedIsBadData) {
  const std::string replay = "replay --model plane.json --mesh plate.obj --trajectory taps.csv --out out.csv ";
  const Outcome lies = run(replay + plugin("LIES_ABOUT_ITS_VERSION"));
  EXPECT_EQ(lies.status, 3);
  EXPECT_THAT(lies.err, HasSubstr("touchstone_result has 24 bytes"));
  const Outcome no_library = run(replay + "--plugin plate.obj");
  EXPECT_EQ(no_library.status, 3);
  EXPECT_THAT(no_library.err, HasSubstr("plate.obj: cannot be loaded as a shared library"));
  const Outcome crash = run(replay + plugin("CRASHES_IN_STEP"));
  EXPECT_EQ(crash.status, 1);
  EXPECT_THAT(crash.err, AllOf(HasSubstr("sample 4"), HasSubstr("crashed (SIGABRT")));
  const Outcome nan = run(replay + plugin("RETURNS_NAN"));
  EXPECT_EQ(nan.status, 1);
  EXPECT_THAT(nan.err, HasSubstr("f_W_N[1] = nan"));
  const Outcome hang = run(replay + plugin("HANGS_IN_STEP") + " --plugin-time-limit 0.3");
  EXPECT_EQ(hang.status, 1);
  EXPECT_THAT(hang.err, HasSubstr("did not come back from touchstone_step within 0.3 s"));
  const Outcome limit = run(replay + plugin("NOTHING") + " --plugin-time-limit -1");
  EXPECT_EQ(limit.status, 2);
  // Nothing of a failed run is left.
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.csv"));
}

TEST_F(PluginCommand, AnUnknownRendererIsSaidWithWhatThePluginHas) {
  write_file(folder_ / "plain.json", R"({"schema": "touchstone-model/1", "renderer": "plain"})");
  const Outcome replay =
      run("replay --model plain.json --mesh plate.obj --trajectory taps.csv --out out.csv " + plugin("NOTHING"));
  EXPECT_EQ(replay.status, 3);
  EXPECT_THAT(replay.err, AllOf(HasSubstr("did you mean \"plane\""), HasSubstr("god-object")));
  const Outcome without = run("replay --model plane.json --mesh plate.obj --trajectory taps.csv --out out.csv");
  EXPECT_EQ(without.status, 3);
  EXPECT_THAT(without.err, Not(HasSubstr("internal error")));
}

}  // namespace
}  // namespace touchstone::apps
