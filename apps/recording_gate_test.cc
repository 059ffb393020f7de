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
    BuiltProgram::SetUp();
    if (folder_.empty()) return;
    write_file(folder_ / "plate.obj", "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "model.json",
               R"({"schema":"touchstone-model/1","renderer":"god-object","parameters":{"stiffness_N_per_m":500}})");
    strokes("good.csv", 1);
    strokes("again.csv", 2);
    strokes("reversed.csv", 1, -1.0);
    strokes("far.csv", 1, 1.0, 1e3);
  }
  // 10 s at 200 Hz on a plate of 500 N/m, with 20 mN of noise.
  void strokes(const std::string& name, std::uint64_t seed, double sign = 1.0, double unit = 1.0) const {
    Random random(seed);
    std::string text = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int i = 0; i < 2000; ++i) {
      const double t = i / 200.0;
      const double z = 0.5e-3 - 1e-3 * (std::sin(2.1 * t) + std::sin(3.7 * t + 1.0));
      const double load = 500.0 * std::max(0.0, -z);
      text += fmt::format("{:.3f},{:.7f},{:.7f},{:.7f},{:.4f},{:.4f},{:.4f}\n", t, unit * 0.04 * std::sin(0.6 * t),
                          unit * 0.03 * std::cos(0.43 * t), unit * z, 0.02 * random.normal(), 0.02 * random.normal(),
                          sign * (load + 0.02 * random.normal()));
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
  // A replay of the true model leaves the noise of one recording, less than what two of them differ by.
  ASSERT_EQ(run("replay --model model.json --mesh plate.obj --trajectory good.csv --out r.csv").status, 0);
  strokes("third.csv", 3);
  const Outcome without = run("compare good.csv third.csv");
  EXPECT_EQ(without.status, 1);
  const Outcome with = run("compare good.csv third.csv --repeat again.csv --json c.json");
  EXPECT_THAT(with.out, HasSubstr("repeat floor: 0.0"));
  const auto json = nlohmann::json::parse(read_file(folder_ / "c.json"));
  // Three axes and two recordings of 20 mN each.
  EXPECT_NEAR(json["repeat_floor"]["force_N"].get<double>(), 0.02 * std::sqrt(6.0), 0.003);
  strokes("weaker.csv", 4, 0.8);
  const Outcome weaker = run("compare good.csv weaker.csv --repeat again.csv --json c.json");
  EXPECT_EQ(weaker.status, 1);
  EXPECT_THAT(weaker.out, HasSubstr(" times the floor of 0.0"));
  EXPECT_FALSE(nlohmann::json::parse(read_file(folder_ / "c.json"))["repeat_floor"]["within"].get<bool>());
  EXPECT_EQ(run("compare good.csv third.csv --repeat far.csv").status, 3);
}

}  // namespace
}  // namespace touchstone::apps
