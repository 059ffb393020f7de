// Golden cases with "loop", as a user makes and checks them: a loop that is stable, held sample by sample, and one that
// buzzes, held by its band and strength.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "harness/base/json_reader.h"
#include "harness/testing/built_program.h"

namespace touchstone::loop {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;

class GoldenLoop : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
    write_file(folder_ / "plate.obj", "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "press.csv", "t_s,x_m,y_m,z_m\n0,0,0,0.0005\n0.1,0,0,-0.002\n0.7,0.002,0,-0.002\n");
    std::filesystem::create_directories(folder_ / "golden/press/expected");
    for (const char* const file : {"plate.obj", "press.csv"})
      std::filesystem::rename(folder_ / file, folder_ / "golden/press" / file);
    const auto model = [](double stiffness) {
      return fmt::format(
          R"({{"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {{"stiffness_N_per_m": {}}}}})",
          stiffness);
    };
    write_file(folder_ / "golden/press/case.json",
               fmt::format(R"({{"schema": "touchstone-golden-case/1", "name": "press", "summary": "a press",
      "surface": {{"mesh": "plate.obj", "unit": "m"}}, "trajectory": {{"file": "press.csv"}},
      "loop": {{"device": "touch-x", "grip": "light", "seed": 1,
               "set": {{"friction_N": 0, "latency_s": 0.001, "jitter_s": 0.0003}}}},
      "models": {{"calm": {}, "buzzing": {}}}, "tolerance": {{"reason": "of the test"}}}})",
                           model(300.0), model(1500.0)));
  }

  // What the case gives becomes its goldens.
  void accept() const {
    const Outcome first = check("");
    ASSERT_EQ(first.status, 1) << first.out << first.err;
    for (const std::string model : {"calm", "buzzing"}) {
      std::filesystem::copy_file(folder_ / "left/press" / model / "obtained.h5",
                                 folder_ / "golden/press/expected" / (model + ".h5"));
    }
  }
  [[nodiscard]] Outcome check(const std::string& more) const { return run("check --golden golden --out left " + more); }
  void change_loop(const char* key, const nlohmann::json& value) const {
    change([&](nlohmann::json& loop) { loop[key] = value; });
  }
  void change_figure(const char* name, double value) const {
    change([&](nlohmann::json& loop) { loop["set"][name] = value; });
  }

 private:
  void change(const std::function<void(nlohmann::json&)>& in_loop) const {
    const auto file = folder_ / "golden/press/case.json";
    nlohmann::json document = load_json(file);
    in_loop(document["loop"]);
    std::ofstream(file) << document.dump(1);
  }
};

TEST_F(GoldenLoop, WhatBuzzesIsHeldByBandAndStrengthAndWhatIsStableBySample) {
  accept();
  if (HasFatalFailure()) return;
  const Outcome measured = check("--ctest");
  EXPECT_EQ(measured.status, 0) << measured.out;
  for (const char* const name : {"stable_margin", "buzz_N", "energy_J"})
    EXPECT_THAT(measured.out, HasSubstr(fmt::format("name=\"{}\"", name)));
  // Another jitter moves every sample of both.
  change_loop("seed", 7);
  EXPECT_EQ(check("--model buzzing").status, 0);
  const Outcome calm = check("--model calm");
  EXPECT_EQ(calm.status, 1) << calm.out;
  EXPECT_THAT(calm.out, HasSubstr("position"));
  change_loop("seed", 1);
  // Another damping is found, and a slower servo by the band, too.
  change_figure("damping_N_s_per_m", 1.0);
  EXPECT_THAT(check("--model buzzing").out, HasSubstr("a difference that is noticed"));
  change_figure("latency_s", 0.004);
  EXPECT_THAT(check("--model buzzing").out,
              AllOf(HasSubstr("another third of an octave"), HasSubstr("the loop's verdict is unstable")));
}

TEST_F(GoldenLoop, WhatCannotBeRunNeverPasses) {
  std::filesystem::create_directory(folder_ / "alone");
  std::filesystem::copy_file(program_, folder_ / "alone/touchstone");
  const Outcome alone =
      testing::run_command("PATH=/usr/bin:/bin ./alone/touchstone check --golden golden --out left", folder_);
  EXPECT_EQ(alone.status, 1) << alone.out << alone.err;
  EXPECT_THAT(alone.out, HasSubstr("touchstone-loop is neither beside this program nor on PATH"));
  change_loop("device", "omega.3");
  EXPECT_THAT(check("--model calm").out, HasSubstr("the device's mass is not published"));
  change_loop("device", "no-such");
  EXPECT_THAT(check("").out, HasSubstr("no-such"));
  change_loop("device", "../touch-x.json");
  EXPECT_EQ(check("").status, 3);
  EXPECT_EQ(run("golden export press --golden golden --to there").status, 3);
}

}  // namespace
}  // namespace touchstone::loop
