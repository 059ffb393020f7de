// Every command that reads a recording says the same of the same fault, with the flag that repairs it; a second
// recording of the same motion is the floor.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/random.h"
#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;

class RecordingGate : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    testing::BuiltProgram::SetUp();
    if (folder_.empty()) return;
    write_file(folder_ / "plate.obj", "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "model.json",
               R"({"schema":"touchstone-model/1","renderer":"god-object","parameters":{"stiffness_N_per_m":500}})");
    strokes("good.csv", 1);
    strokes("again.csv", 2);
    strokes("reversed.csv", 1, -1.0);
    strokes("far.csv", 1, 1.0, 1e3);
  }
  // 10 s at 200 Hz on a plate of 500 N/m.
  void strokes(const std::string& name, std::uint64_t seed, double sign = 1.0, double unit = 1.0, double noise_N = 0.02,
               double hardening_N_per_m2 = 0.0) const {
    Random random(seed);
    std::string text = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int i = 0; i < 2000; ++i) {
      const double t = i / 200.0;
      const double z = 0.5e-3 - 1e-3 * (std::sin(2.1 * t) + std::sin(3.7 * t + 1.0));
      const double depth = std::max(0.0, -z), load = (500.0 + hardening_N_per_m2 * depth) * depth;
      text += fmt::format("{:.3f},{:.7f},{:.7f},{:.7f},{:.4f},{:.4f},{:.4f}\n", t, unit * 0.04 * std::sin(0.6 * t),
                          unit * 0.03 * std::cos(0.43 * t), unit * z, noise_N * random.normal(),
                          noise_N * random.normal(), sign * (load + noise_N * random.normal()));
    }
    write_file(folder_ / name, text);
  }
};

constexpr const char* reversed_words = "give --flip-force";

TEST_F(RecordingGate, AReversedForceIsRefusedAndItsFlagAccepted) {
  for (const std::string command :
       {"replay --model model.json --mesh plate.obj --trajectory {} --out r.csv",
        "evaluate --model model.json --mesh plate.obj --in-trajectory measured --recording {} --out e",
        "fit --model model.json --mesh plate.obj --in-trajectory measured --recording {} --parameter "
        "stiffness_N_per_m=100:2000 --out f",
        "perceive --real {} --model a=model.json --mesh plate.obj --out p"}) {
    const auto with = [&](const std::string& file, const std::string& flag) {
      return run(fmt::format(fmt::runtime(command), file) + flag);
    };
    const Outcome bad = with("reversed.csv", "");
    EXPECT_EQ(bad.status, 3) << command << bad.err;
    EXPECT_THAT(bad.err, HasSubstr(reversed_words)) << command;
    EXPECT_THAT(bad.err, HasSubstr("reversed.csv")) << command;
    EXPECT_EQ(with("reversed.csv", " --flip-force").status, 0) << command;
    const Outcome good = with("good.csv", "");
    EXPECT_EQ(good.status, 0) << command << good.err;
    EXPECT_THAT(good.err, Not(HasSubstr("flip-force"))) << command;
  }
}

TEST_F(RecordingGate, PositionsInAnotherUnitAreRefused) {
  const Outcome bad = run("replay --model model.json --mesh plate.obj --trajectory far.csv --out r.csv");
  EXPECT_EQ(bad.status, 3);
  EXPECT_THAT(bad.err, HasSubstr("far.csv"));
  // Positions alone may be anywhere.
  write_file(folder_ / "free.csv", "t_s,x_m,y_m,z_m\n0,9,9,9\n0.1,9,9,9\n");
  EXPECT_EQ(run("replay --model model.json --mesh plate.obj --trajectory free.csv --out r.csv").status, 0);
}

TEST_F(RecordingGate, CompareNamesTheFaultThatExplainsTheDifference) {
  const Outcome bad = run("compare good.csv reversed.csv");
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.err, HasSubstr("reversed.csv: reversed force"));
  EXPECT_THAT(bad.err, HasSubstr(reversed_words));
  const Outcome flipped = run("compare good.csv reversed.csv --flip-force");
  EXPECT_THAT(flipped.err, Not(HasSubstr("reversed force")));
  EXPECT_THAT(run("compare good.csv far.csv").err, HasSubstr("unit of positions"));
}

TEST_F(RecordingGate, CompareHoldsErrorsAgainstARepeat) {
  strokes("third.csv", 3);
  const Outcome without = run("compare good.csv third.csv");
  EXPECT_EQ(without.status, 1);
  const Outcome with = run("compare good.csv third.csv --repeat again.csv --json c.json");
  EXPECT_THAT(with.out, HasSubstr("repeat floor: 0.0"));
  const auto json = nlohmann::json::parse(read_file(folder_ / "c.json"));
  // Three axes of 20 mN each.
  EXPECT_NEAR(json["repeat_floor"]["force_N"].get<double>(), 0.02 * std::sqrt(3.0), 0.002);
  strokes("weaker.csv", 4, 0.8);
  const Outcome weaker = run("compare good.csv weaker.csv --repeat again.csv --json c.json");
  EXPECT_EQ(weaker.status, 1);
  EXPECT_THAT(weaker.out, HasSubstr(" times the floor of 0.0"));
  EXPECT_FALSE(nlohmann::json::parse(read_file(folder_ / "c.json"))["repeat_floor"]["within"].get<bool>());
  EXPECT_EQ(run("compare good.csv third.csv --repeat far.csv").status, 3);
}

// Tolerances, maps, models and foreign tables are inputs as recordings are.
TEST_F(RecordingGate, NoOutputTakesThePlaceOfAnInput) {
  write_file(folder_ / "tolerance.json", R"({"schema": "touchstone-tolerance/1"})");
  write_file(folder_ / "table.csv", "0,1,0.5\n0.1,1,0.6\n0.2,1,0.7\n");
  write_file(folder_ / "map.json", R"({"schema": "touchstone-import/1", "columns": {"t_s": {"from": "1"},
      "q_m": {"from": "2"}, "force_N": {"from": "3"}}})");
  std::filesystem::create_hard_link(folder_ / "map.json", folder_ / "link.csv");
  for (const auto& [command, file] :
       {std::pair<std::string, std::string>{"import table.csv --map map.json --out", "link.csv"},
        {"import table.csv --map map.json --out", "table.csv"},
        {"import table.csv --map map.json --picture", "map.json"},
        {"compare good.csv again.csv --tolerance tolerance.json --json", "tolerance.json"}}) {
    const std::string before = read_file(folder_ / file);
    const Outcome outcome = run(command + " " + file);
    EXPECT_EQ(outcome.status, 2) << command << outcome.out << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("which this command reads")) << command;
    EXPECT_EQ(read_file(folder_ / file), before) << command;
  }
  EXPECT_EQ(run("import table.csv --map map.json --out new.csv").status, 0);
  EXPECT_EQ(run("import table.csv --map map.json --out new.csv").status, 0) << "an output may be written anew";
}

// Without a map: what is sure is written, what the numbers contradict is not.
TEST_F(RecordingGate, AFileIsImportedWithoutAMapIfNothingIsInDoubt) {
  const Outcome shown = run("import good.csv");
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_THAT(shown.out, AllOf(HasSubstr("2000 samples"), HasSubstr("9.995 s at 200 Hz"), HasSubstr("\nfz_N      fz_N"),
                               HasSubstr("nothing is in doubt")));
  EXPECT_EQ(run("import good.csv --yes --out same.csv").status, 0);
  EXPECT_EQ(run("compare good.csv same.csv").status, 0);
  EXPECT_EQ(run("import good.csv --yes").status, 2);
  EXPECT_EQ(run("import good.csv --out same.csv").status, 2);
  // What is assumed is shown, and what must be asked.
  std::string pressed = "t,x,y,z,Load (N)\n";
  for (int i = 0; i < 40; ++i) pressed += fmt::format("{},0.01,0.02,{},{}\n", 0.01 * i, 0.001 * (i % 9), i % 5);
  write_file(folder_ / "pressed.csv", pressed);
  EXPECT_THAT(run("import pressed.csv").out,
              AllOf(HasSubstr("in doubt: fz_N ('Load (N)')"), HasSubstr("assumed: x_m, y_m, z_m: no unit is named")));
  const Outcome reversed = run("import reversed.csv --yes --out r.csv");
  EXPECT_EQ(reversed.status, 3) << reversed.out;
  EXPECT_THAT(reversed.out, HasSubstr("\"force_sign\": -1"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r.csv"));
  EXPECT_EQ(run("import reversed.csv --guess --map r.json").status, 0);
  EXPECT_EQ(run("import reversed.csv --map r.json --out r.csv").status, 3) << "a question is open";
}

TEST_F(RecordingGate, AnErrorWithinARepeatPasses) {
  // The true model, without noise: it differs by sqrt(3) 0.02 N = 0.035 N, the noise of one run.
  strokes("calm.csv", 5, 1.0, 1.0, 0.0);
  EXPECT_EQ(run("compare good.csv calm.csv").status, 1);
  const Outcome compared = run("compare good.csv calm.csv --repeat again.csv --json c.json");
  EXPECT_EQ(compared.status, 0) << compared.out;
  EXPECT_THAT(compared.out, HasSubstr("within the floor of 0.03"));
  EXPECT_TRUE(nlohmann::json::parse(read_file(folder_ / "c.json"))["repeat_floor"]["within"].get<bool>());
  // The true model leaves the noise of one run, 0.035 N.
  const Outcome evaluated = run(
      "evaluate --model model.json --mesh plate.obj --in-trajectory measured --recording good.csv --repeat again.csv "
      "--out e");
  EXPECT_EQ(evaluated.status, 0) << evaluated.err;
  EXPECT_THAT(evaluated.out + evaluated.err, HasSubstr("within the floor of 0.03"));
  const Outcome fitted =
      run("fit --model model.json --mesh plate.obj --in-trajectory measured --recording good.csv --repeat again.csv "
          "--parameter stiffness_N_per_m=100:2000 --out f");
  EXPECT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_THAT(fitted.out, HasSubstr("within the floor of 0.03"));
}

TEST_F(RecordingGate, WhatARepeatCoversIsNotUnexplained) {
  const Outcome found = run(
      "discrepancy --model model.json --mesh plate.obj --recording good.csv --repeat again.csv --out d --json d.json");
  EXPECT_EQ(found.status, 0) << found.err;
  const auto json = nlohmann::json::parse(read_file(folder_ / "d.json"));
  EXPECT_EQ(json["verdict"], "consistent") << found.out;
  EXPECT_NEAR(json["gap"]["repeat_floor"].get<double>(), 0.02 * std::sqrt(3.0), 0.002);
}

// Which run is the repeat of which does not matter.
TEST_F(RecordingGate, TheOrderOfTheTwoRunsDoesNotMatterAndAnErrorAboveTheFloorIsCounted) {
  const auto searched = [&](const std::string& files) {
    const Outcome found = run("discrepancy --model model.json --mesh plate.obj --out d --json d.json " + files);
    EXPECT_EQ(found.status, 0) << found.err;
    return nlohmann::json::parse(read_file(folder_ / "d.json"));
  };
  const auto one = searched("--recording good.csv --repeat again.csv");
  const auto turned = searched("--recording again.csv --repeat good.csv");
  EXPECT_EQ(turned["verdict"], "consistent");
  EXPECT_NEAR(turned["gap"]["repeat_floor"].get<double>(), one["gap"]["repeat_floor"].get<double>(), 0.002);
  const auto held = searched("--recording good.csv --holdout again.csv --repeat again.csv");
  EXPECT_EQ(held["verdict"], "consistent");
  // A plate that stiffens, which the model's spring does not: more than the runs differ by.
  strokes("hard.csv", 10, 1.0, 1.0, 0.02, 5e5), strokes("hard-again.csv", 11, 1.0, 1.0, 0.02, 5e5);
  const auto hard = searched("--recording hard.csv --repeat hard-again.csv");
  EXPECT_NE(hard["verdict"], "consistent") << hard["explanation"];
  EXPECT_LT(hard["gap"]["repeat_floor"].get<double>(), hard["gap"]["holdout"]["before"].get<double>());
  // The repeat of another motion is none.
  EXPECT_EQ(run("discrepancy --model model.json --mesh plate.obj --recording good.csv --repeat far.csv --out d").status,
            3);
}

TEST_F(RecordingGate, AJointGoesThroughFitAndDiscrepancyWithoutObjectOrModel) {
  Random random(7);
  std::string text = "t_s,q_rad,torque_Nm\n";
  for (int i = 0; i < 6000; ++i) {
    const double t = i / 200.0;
    const double q = std::sin(0.6 * t) + 0.3 * std::sin(2.3 * t),
                 qd = 0.6 * std::cos(0.6 * t) + 0.69 * std::cos(2.3 * t);
    text += fmt::format("{:.3f},{:.6f},{:.5f}\n", t, q,
                        (qd > 0.0 ? 0.07 : -0.07) + 0.2 * std::sin(1.5 * q) + 0.005 * random.normal());
  }
  write_file(folder_ / "joint.csv", text);
  for (const std::string command : {"fit", "discrepancy"}) {
    const Outcome found = run(command + " --recording joint.csv --out " + command);
    EXPECT_EQ(found.status, 0) << found.err;
    EXPECT_THAT(found.out, HasSubstr("dry friction"));
    EXPECT_THAT(found.out, HasSubstr("torque over angle"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / command / "axis.json"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / command / "report.html"));
    const Outcome wrong = run(command + " --recording joint.csv --mesh plate.obj --out wrong");
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("is a recording of one axis"));
    EXPECT_EQ(run(command + " --recording good.csv --out wrong").status, 2);
  }
  const Outcome evaluated = run("evaluate --model model.json --mesh plate.obj --recording joint.csv --out wrong");
  EXPECT_EQ(evaluated.status, 3);
  EXPECT_THAT(evaluated.err, HasSubstr("touchstone axis"));
}

}  // namespace
}  // namespace touchstone::apps
