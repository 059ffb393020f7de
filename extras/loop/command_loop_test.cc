// `touchstone loop` as a user runs it: what it writes, and what it says of what it cannot use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "harness/base/json_reader.h"
#include "harness/testing/built_program.h"

namespace touchstone::loop {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;

class LoopCommand : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
    write_file(folder_ / "plate.obj", "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "soft.json", model(300.0));
    write_file(folder_ / "stiff.json", model(40000.0));
    write_file(folder_ / "press.csv",
               "t_s,x_m,y_m,z_m\n0,0,0,0.003\n0.4,0,0,-0.002\n1.4,0.004,0,-0.002\n1.6,0.004,0,0.003\n");
  }
  static std::string model(double stiffness) {
    return fmt::format(
        R"({{"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {{"stiffness_N_per_m": {}}}}})",
        stiffness);
  }
  [[nodiscard]] Outcome loop(const std::string& model_file, const std::string& more) const {
    return run(fmt::format("loop --model {} --mesh plate.obj --path press.csv {}", model_file, more));
  }
  [[nodiscard]] nlohmann::json result(const std::string& out) const { return load_json(folder_ / out / "result.json"); }
};

constexpr const char* exact = "--set mass_kg=0.1 --set friction_N=0 --set resolution_m=0";

TEST_F(LoopCommand, ASoftWallIsStableAndAStiffOneIsNot) {
  const Outcome soft = loop("soft.json", std::string("--device touch --grip light --out soft ") + exact);
  ASSERT_EQ(soft.status, 0) << soft.err;
  EXPECT_THAT(soft.out, HasSubstr("Stable"));
  EXPECT_EQ(result("soft").at("verdict"), "stable");
  EXPECT_GT(result("soft").at("stable_margin").get<double>(), 2.0);
  EXPECT_THAT(read_file(folder_ / "soft" / "report.html"), HasSubstr("Will it buzz?"));
  const Outcome stiff = loop("stiff.json", std::string("--device touch --grip light --out stiff ") + exact);
  ASSERT_EQ(stiff.status, 0) << stiff.err;
  EXPECT_EQ(result("stiff").at("verdict"), "unstable");
  EXPECT_LT(result("stiff").at("stable_margin").get<double>(), 1.0);
}

// A ball of 30 mm on another one: the contact is not below the handle, and its force turns the tool.
TEST_F(LoopCommand, AToolWithAShapeIsHeldByItsHandle) {
  ASSERT_EQ(run("synth --surface sphere --triangles 80 --out ball.obj").status, 0);  // of 30 mm
  write_file(folder_ / "over.csv", "t_s,x_m,y_m,z_m\n0,0.01,0,0.06\n0.2,0.01,0,0.052\n0.8,0.011,0,0.052\n");
  const std::string words = std::string("loop --tool ball.obj --mesh ball.obj --path over.csv ") + exact;
  const Outcome held = run(words + " --renderer god-object-tool --stiffness 300 --out tool");
  ASSERT_EQ(held.status, 0) << held.err;
  EXPECT_THAT(held.out, HasSubstr("not fed to the hand: the torque about the handle"));
  EXPECT_EQ(result("tool").at("verdict"), "stable");
  EXPECT_GT(result("tool").at("torque").at("largest_Nm").get<double>(), 0.0);
  EXPECT_EQ(run(words + " --renderer god-object-tol --out none").status, 2);
  EXPECT_EQ(run(words + " --out none").status, 2);
  EXPECT_EQ(run(words + " --renderer god-object-tool --model soft.json --out none").status, 2);
  EXPECT_EQ(loop("soft.json", "--renderer god-object-tool --out none").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

TEST_F(LoopCommand, WhatIsRenderedIsAFileLikeThatOfAReplay) {
  ASSERT_EQ(loop("soft.json", std::string("--out r --rendered one.csv ") + exact).status, 0);
  EXPECT_EQ(run("compare one.csv one.csv").status, 0);
  ASSERT_EQ(loop("soft.json", std::string("--out r --rendered two.csv --set damping_N_s_per_m=1 ") + exact).status, 0);
  EXPECT_EQ(run("compare one.csv two.csv").status, 1);
}

TEST_F(LoopCommand, RepeatsToTheByteButForTheTimeThatItTook) {
  std::vector<nlohmann::json> results;
  for (const char* out : {"one", "two"}) {
    ASSERT_EQ(loop("soft.json", fmt::format("--device touch-x --set jitter_s=0.0003 --seed 5 --out {}", out)).status,
              0);
    results.push_back(result(out));
    results.back().erase("real_time_factor");
  }
  EXPECT_EQ(results[0].dump(), results[1].dump());
}

TEST_F(LoopCommand, FasterThanRealTimeByAThousand) {
  ASSERT_EQ(run("synth --surface sphere --triangles 10000 --out ball.obj").status, 0);
  write_file(folder_ / "over.csv", "t_s,x_m,y_m,z_m\n0,-0.01,0,0.032\n0.4,-0.01,0,0.026\n9,0.01,0,0.026\n");
  ASSERT_EQ(run("loop --model soft.json --mesh ball.obj --path over.csv --device touch --out ball").status, 0);
  const double factor = result("ball").at("real_time_factor").get<double>();
  fmt::print("real-time factor over 10,000 triangles: {:.0f}\n", factor);
  // 1,000 is aimed at; other work may run beside it, and sanitizers slow it down.
  EXPECT_GT(factor, 10.0);
}

TEST_F(LoopCommand, SaysWhatItCannotUseAndLeavesNoFolder) {
  const auto refused = [&](const std::string& words, int status, const std::string& says) {
    const Outcome outcome = loop("soft.json", words + " --out none");
    EXPECT_EQ(outcome.status, status) << words;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << words;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none")) << words;
  };
  refused("--device touhc", 2, "touch");
  refused("--grip normal", 2, "hand_mass_kg");
  refused("--set mass=1", 2, "mass_kg");
  refused("--set mass_kg=-1", 2, "above 0");
  refused("--set friction_N=-1", 2, "0 or more");
  refused("--set actuator_bandwidth_Hz=1e15", 2, "bandwidth");
  refused("--set period_s=1e-12", 2, "periods");
  refused("--set jitter_s=0.01", 2, "jitter_s");
  write_file(folder_ / "own.json", R"({"schema": "touchstone-device/1", "name": "own", "figures": {"mass_kg": {}}})");
  refused("--device own.json", 3, "/figures/mass_kg");
  write_file(folder_ / "press.csv", "t_s,x_m,y_m,z_m\n0,0,0,0.003\n0.4,0,zero,-0.002\n");
  refused("--device touch", 3, "press.csv");
  EXPECT_EQ(run("loop --device touch").status, 2);
  EXPECT_EQ(run("loop width --points 1").status, 2);
  EXPECT_EQ(run("loop width --over mass").status, 2);
  EXPECT_EQ(run("loop nonsense").status, 2);
}

// Let go beside a spring of 100 N/m on a device of 0.2 kg with a friction of 2 N s/m: x'' = -(100 x + 2 x') / 0.2.
TEST_F(LoopCommand, FitMakesADeviceFileThatTheLoopTakes) {
  std::string csv = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
  const double decay = 5.0, w = std::sqrt(500.0 - decay * decay);
  for (int k = 0; k < 800; ++k) {
    const double t = 1e-3 * k;
    const double x = 0.02 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    csv += fmt::format("{},0,{:.9f},0,0,{:.9f},0\n", t, x, -100.0 * x);
  }
  write_file(folder_ / "release.csv", csv);
  const Outcome fit = run("loop fit --recording release.csv --name mine --out mine.json");
  ASSERT_EQ(fit.status, 0) << fit.err;
  EXPECT_THAT(fit.out, ::testing::ContainsRegex("viscous friction +1[0-9] %"));
  EXPECT_THAT(fit.out, ::testing::ContainsRegex("dry friction .*negligible"));
  const auto sheet = load_json(folder_ / "mine.json");
  EXPECT_NEAR(sheet.at("figures").at("mass_kg").at("value").get<double>(), 0.2, 0.004);
  EXPECT_EQ(loop("soft.json", "--device mine.json --grip light --out own").status, 0);
  EXPECT_EQ(run("loop fit --recording press.csv --out none.json").status, 3);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.json"));
}

// In free air a device without friction goes where the hand means it to be, and no force acts.
TEST_F(LoopCommand, ARecordingOfTheDeviceIsHeldBesideTheSimulation) {
  write_file(folder_ / "press.csv", "t_s,x_m,y_m,z_m\n0,0,0,0.003\n2,0.01,0,0.003\n");
  std::string same = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n", other = same;
  for (int k = 0; k < 1000; ++k) {
    const double t = 7.0 + 1e-3 * k, x = 0.0025 + 5e-6 * k;
    same += fmt::format("{},{},0,0.003,0,0,0\n", t, x);
    other += fmt::format("{},{},0,0.003,0,0,0.5\n", t, x);
  }
  write_file(folder_ / "same.csv", same);
  write_file(folder_ / "other.csv", other);
  const std::string air = std::string("--out r ") + exact + " --recording ";
  const Outcome agrees = loop("soft.json", air + "same.csv");
  EXPECT_EQ(agrees.status, 0) << agrees.out << agrees.err;
  const auto found = result("r").at("recording");
  EXPECT_EQ(found.at("agrees"), true);
  EXPECT_NEAR(found.at("shift_s").get<double>(), 0.5 - 7.0, 1e-3);
  EXPECT_LT(found.at("difference_m").get<double>(), 1e-6);
  const Outcome differs = loop("soft.json", air + "other.csv");
  EXPECT_EQ(differs.status, 1) << differs.out << differs.err;
  EXPECT_THAT(differs.out, HasSubstr("differs from the simulation"));
  EXPECT_EQ(loop("soft.json", air + "press.csv").status, 3);
}

TEST_F(LoopCommand, WidthAndTuneWriteWhatTheySay) {
  ASSERT_EQ(run("loop width --device touch --grip light --over latency --points 2 --out w").status, 0);
  EXPECT_EQ(result("w").at("grips").at(0).at("points").size(), 2u);
  const Outcome tuned = run("loop tune --device touch --grip light --json tuned.json");
  ASSERT_EQ(tuned.status, 0) << tuned.err;
  EXPECT_EQ(load_json(folder_ / "tuned.json").at("devices").at(0).at("published_N_per_m"), 400.0);
}

TEST_F(LoopCommand, TheAtlasNamesWhatIsFelt) {
  ASSERT_EQ(run("loop atlas --device touch --out a").status, 0);
  EXPECT_EQ(result("a").at("cells").size(), 81u);
  EXPECT_TRUE(result("a").at("findings").empty());
  for (const auto& cell : result("a").at("cells")) {
    const bool unknown_limit = cell.at("renderer") == "spring-quadratic" && cell.at("case") == "passive plane";
    EXPECT_EQ(cell.at("refused") == "", !unknown_limit) << cell;
  }
  // Friction before it slides is stiffer than the spring: late, it buzzes with every renderer, and so with the
  // god-object, which is no finding; a ball against single triangles is not the god-object.
  const std::string late = "loop atlas --device touch-x --stiffness 1000 --set friction_N=0 --set latency_s=0.0015 ";
  const Outcome same = run(late + "--renderer friction-cone --case 'plane, friction 0.4'");
  EXPECT_EQ(same.status, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("buzzes"));
  EXPECT_EQ(run("loop atlas --renderer spring-quadratic --case 'passive plane'").status, 77);
  const Outcome vain = run("loop atlas --renderer god-object --case 'passive plane' --allow kick");
  EXPECT_EQ(vain.status, 0) << vain.out;
  EXPECT_THAT(vain.out, HasSubstr("allowed and not found: kick"));
  EXPECT_EQ(run("loop atlas --allow kicks").status, 2);
  EXPECT_EQ(run("loop atlas --renderer god-objekt").status, 2);
  EXPECT_EQ(run("loop atlas --case cube").status, 2);
}

// The table of docs/explanation/closed-loop.md is what this prints.
TEST_F(LoopCommand, PublishedStiffnessesBesideThePredictedAreTheTableOfThePage) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  if (source == nullptr) GTEST_SKIP() << "TOUCHSTONE_SOURCE_DIR does not say where the page is";
  ASSERT_EQ(run("loop tune --margin 1 --json tuned.json").status, 0);
  const auto rounded = [](double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
    return fmt::format("{:.0f}", std::round(value / unit) * unit);
  };
  std::string table = "| device | predicted [N/m] | published [N/m] |\n|---|---|---|\n";
  const auto tuned = load_json(folder_ / "tuned.json").at("devices");
  for (const auto& device : tuned) {
    const auto& published = device.at("published_N_per_m");
    table += fmt::format("| {} | {} | {} |\n", device.at("device").get<std::string>(),
                         rounded(device.at("undamped_N_per_m").get<double>()),
                         published.is_null() ? "none" : fmt::format("{:g}", published.get<double>()));
  }
  fmt::print("{}", table);
  EXPECT_THAT(read_file(std::filesystem::path(source) / "docs" / "explanation" / "closed-loop.md"), HasSubstr(table));
}

}  // namespace
}  // namespace touchstone::loop
