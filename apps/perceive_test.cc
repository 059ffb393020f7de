// The program's commands perceive and experiment, run as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/testing/built_program.h"

namespace touchstone {
namespace {

using ::testing::HasSubstr;

using testing::Outcome;

class Program : public testing::BuiltProgram {
 protected:
  void press(const std::string& name, double k, double exponent, double seconds = 3.0) const {
    std::string text = "t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N\n";
    for (int n = 0; n < static_cast<int>(seconds * 500); ++n) {
      const double share = 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * n / 500.0));
      text +=
          fmt::format("{:.3f},0,0,{:.6f},0,0,{:.6f}\n", n / 500.0, -10.0 * share, 0.01 * k * std::pow(share, exponent));
    }
    write_file(folder_ / name, text);
  }
};

TEST_F(Program, PerceiveRanksRecordingsModelsAndAnswers) {
  press("real.csv", 500, 1);
  press("close.csv", 480, 1);
  press("odd.csv", 500, 2);
  write_file(folder_ / "model.json",
             R"({"schema":"touchstone-model/1","renderer":"spring-linear","parameters":{"stiffness_N_per_m":300}})");
  write_file(folder_ / "plane.obj", "v -100 -100 0\nv 100 -100 0\nv 100 100 0\nv -100 100 0\nf 1 2 3\nf 1 3 4\n");
  std::string answers = "subject,first,second,chosen\n";
  for (const char* const subject : {"a", "b"}) {
    answers += fmt::format("{0},close,odd,close\n{0},odd,close,close\n{0},close,soft,close\n{0},soft,close,{1}\n",
                           subject, subject[0] == 'a' ? "close" : "soft");
    answers += fmt::format("{0},odd,soft,soft\n{0},soft,odd,{1}\n", subject, subject[0] == 'a' ? "soft" : "odd");
  }
  write_file(folder_ / "answers.csv", answers);
  const auto outcome =
      run("perceive --real real.csv --condition close=close.csv --condition odd=odd.csv --model soft=model.json "
          "--mesh plane.obj --mesh-unit mm --answers answers.csv --out perceived");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(read_file(folder_ / "perceived/perception.json"));
  EXPECT_EQ(json["schema"], "touchstone-perception/1");
  EXPECT_EQ(json["methods"][0]["ranking"][0], "close");
  EXPECT_EQ(json["conditions"][0]["rank"], 1);
  EXPECT_EQ(json["subjective"]["answers"], 12);
  EXPECT_EQ(json["subjective"]["agreement"][0]["method"], "perception-space");
  EXPECT_THAT(read_file(folder_ / "perceived/report.html"), HasSubstr("Where statistics disagree"));
}

TEST_F(Program, PerceiveSaysWhatIsWrong) {
  press("real.csv", 500, 1);
  press("long.csv", 500, 1, 6.0);
  const auto refused = [&](const std::string& arguments) {
    return run("perceive --real real.csv --out perceived " + arguments);
  };
  EXPECT_EQ(refused("").status, 2);
  EXPECT_EQ(refused("--condition nothing").status, 2);
  EXPECT_EQ(refused("--condition a=real.csv --scaling big").status, 2);
  EXPECT_EQ(refused("--condition a=real.csv --direction up").status, 2);
  EXPECT_EQ(refused("--model a=m.json").status, 2);
  const auto missing = refused("--condition a=absent.csv");
  EXPECT_EQ(missing.status, 3);
  EXPECT_THAT(missing.err, HasSubstr("absent.csv"));
  const auto longer = refused("--condition a=long.csv");
  EXPECT_EQ(longer.status, 3);
  EXPECT_THAT(longer.err, HasSubstr("condition 'a' lasts"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "perceived/perception.json"));
}

TEST_F(Program, ExperimentSpringsWritesItsReportAndModels) {
  const auto outcome = run("experiment springs --seeds 1 --out springs");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "springs/springs.json"))["seeds"], 1);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "springs/Omega.7-quadratic.json"));
  EXPECT_EQ(run("experiment").status, 2);
  EXPECT_EQ(run("experiment springs --seeds 0 --out springs").status, 2);
}

TEST_F(Program, ExperimentPalpationComparesTheRowsOfARaster) {
  // Rows to and fro over a bumpy spring, 1 mm apart, two presses a second at 66 Hz.
  std::string text = "t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N\n";
  for (int n = 0; n < 66 * 80; ++n) {
    const double t = n / 66.0;
    const double row = std::floor(t / 8.0);
    const double along = t / 8.0 - row;
    const double x = 20.0 * (static_cast<int>(row) % 2 == 0 ? along : 1.0 - along);
    const double surface = 2.0 * std::sin(0.6 * x);
    const double depth = 2.0 * (1.0 - std::cos(4.0 * std::numbers::pi * t)) - 0.4;
    text +=
        fmt::format("{:.4f},{:.4f},{:.4f},{:.6f},0,0,{:.6f}\n", t, x, row, surface - depth, 0.5 * std::max(0.0, depth));
  }
  write_file(folder_ / "raster.csv", text);
  const auto outcome = run("experiment palpation --recording raster.csv --presses 8 --out palpation");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto json = nlohmann::json::parse(read_file(folder_ / "palpation/palpation.json"));
  EXPECT_GE(json["compared"], 3);
  EXPECT_EQ(json["measured_nearer"], json["compared"]);
  press("one row.csv", 500, 1);
  const auto refused = run("experiment palpation --recording 'one row.csv' --out none");
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("a raster with at least two was expected"));
}

}  // namespace
}  // namespace touchstone
