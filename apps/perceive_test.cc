// The program's commands perceive and experiment, run as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::HasSubstr;

using testing::Outcome;

class Program : public testing::BuiltProgram {
 protected:
  // Presses of 10 mm from 1 mm above the surface; `sideways_N` across from 2 mm on.
  void press_from_the_air(const std::string& name, double k, double sideways_N = 0.0, double seconds = 5.0) const {
    std::string text = "t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N\n";
    for (int n = 0; n < static_cast<int>(seconds * 500); ++n) {
      const double depth = -1.0 + 5.5 * (1.0 - std::cos(2.0 * std::numbers::pi * n / 500.0));
      text += fmt::format("{:.3f},0,0,{:.6f},{:.6f},0,{:.6f}\n", n / 500.0, -depth, depth > 2.0 ? sideways_N : 0.0,
                          1e-3 * k * std::max(0.0, depth));
    }
    write_file(folder_ / name, text);
  }
  [[nodiscard]] nlohmann::json perceived() const {
    return nlohmann::json::parse(read_file(folder_ / "perceived/perception.json"));
  }
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

TEST_F(Program, PerceiveByThePaperRanksRecordingsModelsAndAnswers) {
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
      run("perceive --method paper --real real.csv --condition close=close.csv --condition odd=odd.csv --model "
          "soft=model.json "
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

// A tip that slides over a rigid plate never goes into it: along the path as measured every model is without force.
TEST_F(Program, PerceiveFeedsModelsTheForceWhereTheObjectIsRigid) {
  constexpr double mu = 0.7;
  std::string text = "t_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N\n";
  for (int n = 0; n < 5000; ++n) {
    const double phase = 2.0 * std::numbers::pi * n / 1000.0, press = std::max(0.0, std::sin(phase));
    text += fmt::format("{:.3f},{:.6f},0,{:.6f},{:.6f},0,{:.6f}\n", 0.001 * n, 0.02 * n,
                        std::max(0.0, -5.0 * std::sin(phase)), -mu * 1.5 * press, 1.5 * press);
  }
  write_file(folder_ / "slide.csv", text);
  write_file(folder_ / "plate.obj", "v -200 -200 0\nv 200 -200 0\nv 200 200 0\nv -200 200 0\nf 1 2 3\nf 1 3 4\n");
  const auto model = [&](const std::string& name, double friction) {
    write_file(folder_ / name, fmt::format(R"({{"schema":"touchstone-model/1","renderer":"friction-cone","parameters":)"
                                           R"({{"stiffness_N_per_m":600,"mu_static":{0},"mu_dynamic":{0}}}}})",
                                           friction));
  };
  model("right.json", mu);
  model("slippery.json", 0.05);
  const std::string command =
      "perceive --real slide.csv --mesh plate.obj --mesh-unit mm --model right=right.json --model "
      "slippery=slippery.json "
      "--out perceived ";
  const auto noticed = [&](const std::string& options) {
    const auto outcome = run(command + options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    std::map<std::string, std::string> verdicts;
    const nlohmann::json json = perceived();
    for (const auto& condition : json["conditions"])
      verdicts[condition.at("name").get<std::string>()] = condition.at("verdict").get<std::string>();
    return std::pair(verdicts, outcome.err);
  };
  const auto [usual, said] = noticed("");
  EXPECT_NE(usual.at("right"), "noticed") << said;
  EXPECT_EQ(usual.at("slippery"), "noticed") << said;
  EXPECT_THAT(said, HasSubstr("in-trajectory: whole-force"));
  EXPECT_EQ(noticed("--in-trajectory measured").first.at("right"), "noticed") << "next to no force";
  // An object that gives way is judged along the path as measured.
  press_from_the_air("soft.csv", 500);
  const auto soft =
      run("perceive --real soft.csv --mesh plate.obj --mesh-unit mm --model right=right.json --out perceived");
  EXPECT_EQ(soft.status, 0) << soft.err;
  EXPECT_EQ(soft.err.find("in-trajectory"), std::string::npos) << soft.err;
}

TEST_F(Program, PerceiveSaysHowLikelyAPersonNoticesAndByWhat) {
  press_from_the_air("real.csv", 500);
  press_from_the_air("again.csv", 500, 0.0, 8.0);
  press_from_the_air("soft.csv", 350);
  press_from_the_air("pulled.csv", 500, 5.0);
  const auto outcome = run(
      "perceive --real real.csv --condition soft=soft.csv --condition pulled=pulled.csv --condition again=again.csv "
      "--out perceived");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("a person tells it"));
  const auto json = perceived();
  EXPECT_EQ(json["schema"], "touchstone-perception/2");
  ASSERT_EQ(json["conditions"].size(), 3u);
  for (const auto& c : json["conditions"]) {
    EXPECT_GE(c["noticed_probability"].get<double>(), 0.5);
    EXPECT_LE(c["noticed_probability"].get<double>(), 1.0);
    ASSERT_EQ(c["noticed_interval95"].size(), 2u);
    EXPECT_TRUE(c["d_prime"].is_number());
    ASSERT_GE(c["channels"].size(), 3u);
    for (const auto& channel : c["channels"]) {
      EXPECT_TRUE(channel["name"].is_string() && channel["jnd"].is_number() && channel["probability"].is_number());
    }
    // Other authors' metrics stand beside it, ST-SIM, SPQI and Stevens' law too.
    for (const char* const name :
         {"perception-space", "euclidean", "pmse", "structural-similarity", "st-sim", "spqi", "stevens"})
      EXPECT_TRUE(c["other_metrics"].contains(name)) << name;
  }
  const auto& soft = json["conditions"][0];
  const auto& pulled = json["conditions"][1];
  const auto& again = json["conditions"][2];
  EXPECT_EQ(soft["verdict"], "noticed");
  EXPECT_TRUE(soft["gives_away"] == "force" || soft["gives_away"] == "stiffness") << soft["gives_away"];
  // 5 N of sideways force never ranks before a repeat.
  EXPECT_EQ(again["rank"], 1);
  EXPECT_EQ(again["verdict"], "not-noticed");
  EXPECT_GT(pulled["d_prime"].get<double>(), 2.0);
}

TEST_F(Program, PerceiveJudgesAPairByItselfToTheBit) {
  press_from_the_air("real.csv", 500);
  press_from_the_air("soft.csv", 450);
  press_from_the_air("pulled.csv", 500, 5.0);
  ASSERT_EQ(run("perceive --real real.csv --condition soft=soft.csv --out perceived").status, 0);
  auto alone = perceived()["conditions"][0];
  ASSERT_EQ(
      run("perceive --real real.csv --condition pulled=pulled.csv --condition soft=soft.csv --out perceived").status,
      0);
  auto beside = perceived()["conditions"][1];
  // What ranks them is of the list; all else is of the pair.
  for (const char* const of_the_list : {"rank", "group", "behind_probability"}) {
    alone.erase(of_the_list);
    beside.erase(of_the_list);
  }
  EXPECT_EQ(alone, beside);
}

TEST_F(Program, PerceiveTakesThresholdsRepeatsAndTheInstrument) {
  press_from_the_air("real.csv", 500);
  press_from_the_air("firm.csv", 600);
  press_from_the_air("weak.csv", 400);
  press_from_the_air("soft.csv", 450);
  write_file(folder_ / "numb.json", R"({"schema": "touchstone-thresholds/1", "force_fraction_above": 0.9,
                                         "force_fraction_below": 0.9, "stiffness_fraction": 0.9})");
  write_file(folder_ / "instrument.json", R"({"schema": "touchstone-instrument/1", "force_noise_N": 0.001,
                                               "position_noise_m": 1e-5, "position_rate_Hz": 250,
                                               "geometry_error_m": 0.001})");
  const auto judged = [&](const std::string& options) {
    const auto outcome = run("perceive --real real.csv --condition soft=soft.csv --out perceived " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return perceived()["conditions"][0];
  };
  const double plain = judged("--depth-known")["d_prime"];
  EXPECT_GT(plain, 1.0);
  // 10 % of a spring is less than the 22 % that a free hand needs.
  EXPECT_LT(judged("")["d_prime"].get<double>(), 0.7);
  EXPECT_LT(judged("--depth-known --thresholds numb.json")["d_prime"].get<double>(), 0.5);
  EXPECT_FALSE(judged("--depth-known --repeat firm.csv --repeat weak.csv")["above_noise"].get<bool>());
  const auto declared = judged("--depth-known --instrument instrument.json");
  EXPECT_LT(declared["d_prime"].get<double>(), plain);
  EXPECT_EQ(run("perceive --real real.csv --condition a=soft.csv --without taste --out perceived").status, 2);
  write_file(folder_ / "wrong.json", R"({"schema": "touchstone-thresholds/1", "force": 1})");
  EXPECT_EQ(run("perceive --real real.csv --condition a=soft.csv --thresholds wrong.json --out perceived").status, 3);
}

TEST_F(Program, PerceiveContinuesTheOpenEdgesOfAMeshAndSaysSo) {
  press_from_the_air("real.csv", 500);
  write_file(folder_ / "model.json",
             R"({"schema":"touchstone-model/1","renderer":"god-object","parameters":{"stiffness_N_per_m":500}})");
  // The mesh ends 2 mm before the place that is pressed.
  write_file(folder_ / "plane.obj", "v -100 -100 0\nv -2 -100 0\nv -2 100 0\nv -100 100 0\nf 1 2 3\nf 1 3 4\n");
  const std::string command =
      "perceive --real real.csv --model same=model.json --mesh plane.obj --mesh-unit mm --out perceived ";
  const auto outcome = run(command);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("open edges were continued"));
  EXPECT_EQ(perceived()["conditions"][0]["verdict"], "not-noticed");
  const auto by_the_paper = run(command + "--method paper");
  ASSERT_EQ(by_the_paper.status, 0) << by_the_paper.err;
  EXPECT_THAT(by_the_paper.err, HasSubstr("open edges were continued"));
}

TEST_F(Program, PerceiveByThePaperSaysWhatItDoesNotCompare) {
  press_from_the_air("real.csv", 500, 0.0, 10.0);
  press_from_the_air("long.csv", 500, 0.0, 11.5);
  press_from_the_air("pulled.csv", 400, 5.0, 10.0);
  press_from_the_air("soft.csv", 300, 0.0, 10.0);
  const auto outcome =
      run("perceive --method paper --real real.csv --condition long=long.csv --condition pulled=pulled.csv "
          "--condition soft=soft.csv --out perceived");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("condition 'long' lasts 11.5 s"));
  EXPECT_THAT(outcome.err, HasSubstr("condition 'pulled': "));
  EXPECT_THAT(outcome.err, HasSubstr("across the direction of pressing"));
  EXPECT_THAT(outcome.err, HasSubstr("adding or removing one may change the order of the others"));
  const auto all =
      run("perceive --method paper --explained 1 --real real.csv --condition long=long.csv --condition soft=soft.csv "
          "--out perceived");
  ASSERT_EQ(all.status, 0) << all.err;
  EXPECT_EQ(all.err.find("adding or removing"), std::string::npos);
}

TEST_F(Program, PerceiveByThePaperTakesSeveralMeasuringParts) {
  for (const char* const who : {"real", "soft"}) {
    press(fmt::format("{}-thumb.csv", who), who[0] == 'r' ? 500 : 400, 1);
    press(fmt::format("{}-finger.csv", who), who[0] == 'r' ? 300 : 200, 1);
  }
  const auto outcome = run(
      "perceive --method paper --real real-thumb.csv+real-finger.csv --condition soft=soft-thumb.csv+soft-finger.csv "
      "--out perceived");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(perceived()["features"].size(), 8u);
  EXPECT_EQ(run("perceive --method paper --real real-thumb.csv+real-finger.csv --condition soft=soft-thumb.csv --out "
                "perceived")
                .status,
            3);
}

TEST_F(Program, PerceiveSaysWhatIsWrong) {
  press("real.csv", 500, 1);
  press("long.csv", 500, 1, 6.0);
  const auto refused = [&](const std::string& arguments) {
    return run("perceive --method paper --real real.csv --out perceived " + arguments);
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
}  // namespace touchstone::apps
