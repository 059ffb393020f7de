// Golden cases with "loop", as a user makes and checks them: a loop that is stable, held sample by sample, and one that
// buzzes, held by its band and strength.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "harness/base/json_reader.h"
#include "harness/testing/built_program.h"

namespace touchstone::loop {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;

class GoldenLoop : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
    write_file(folder_ / "plate.obj", "v -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "press.csv",
               "t_s,x_m,y_m,z_m\n0,0,0,0.003\n0.4,0,0,-0.002\n1.4,0.004,0,-0.002\n1.6,0.004,0,0.003\n");
    for (const auto& [name, stiffness] : {std::pair{"calm", 300}, {"buzzing", 1500}}) {
      write_file(folder_ / (std::string(name) + ".json"),
                 fmt::format(R"({{"schema": "touchstone-model/1", "renderer": "god-object", "parameters": )"
                             R"({{"stiffness_N_per_m": {}}}}})",
                             stiffness));
    }
  }

  // A case whose servo jitters, and its goldens.
  void make() const {
    const Outcome made =
        run("golden new press --mesh plate.obj --trajectory press.csv --model calm.json --model buzzing.json --golden "
            "golden --out left --device touch-x --set friction_N=0 --set latency_s=0.001 --set jitter_s=0.0003");
    ASSERT_EQ(made.status, 0) << made.err;
    std::filesystem::create_directories(folder_ / "golden/press/expected");
    for (const std::string model : {"calm", "buzzing"}) {
      std::filesystem::copy_file(folder_ / "left/press" / model / "obtained.h5",
                                 folder_ / "golden/press/expected" / (model + ".h5"));
    }
    ASSERT_EQ(check("").status, 0);
  }
  [[nodiscard]] Outcome check(const std::string& more) const { return run("check --golden golden --out left " + more); }
  template <class Change>
  void change_case(const Change& change) const {
    const auto file = folder_ / "golden/press/case.json";
    nlohmann::json document = load_json(file);
    change(document);
    std::ofstream(file) << document.dump(1);
  }
};

TEST_F(GoldenLoop, WhatBuzzesIsHeldByBandAndStrengthAndWhatIsStableBySample) {
  make();
  if (HasFatalFailure()) return;
  const Outcome measured = check("--ctest");
  for (const char* const name : {"stable_margin", "buzz_N", "energy_J"})
    EXPECT_THAT(measured.out, HasSubstr(fmt::format("name=\"{}\"", name)));
  // Another jitter moves every sample of both.
  change_case([](nlohmann::json& document) { document["loop"]["seed"] = 7; });
  const Outcome buzzing = check("--model buzzing");
  EXPECT_EQ(buzzing.status, 0) << buzzing.out;
  const Outcome calm = check("--model calm");
  EXPECT_EQ(calm.status, 1) << calm.out;
  EXPECT_THAT(calm.out, HasSubstr("force"));
}

TEST_F(GoldenLoop, AnotherDampingIsFound) {
  make();
  if (HasFatalFailure()) return;
  change_case([](nlohmann::json& document) { document["loop"]["set"]["damping_N_s_per_m"] = 1.0; });
  const Outcome buzzing = check("--model buzzing");
  EXPECT_EQ(buzzing.status, 1) << buzzing.out;
  EXPECT_THAT(buzzing.out, HasSubstr("the stable margin is"));
  EXPECT_EQ(check("--model calm").status, 1);
  // Slower, it buzzes in another band.
  change_case([](nlohmann::json& document) {
    document["loop"]["set"]["damping_N_s_per_m"] = 0.0;
    document["loop"]["set"]["latency_s"] = 0.003;
  });
  const Outcome slower = check("--model buzzing");
  EXPECT_EQ(slower.status, 1) << slower.out;
  EXPECT_THAT(slower.out, HasSubstr("another third of an octave"));
}

TEST_F(GoldenLoop, WithoutWhatClosesTheLoopNothingPasses) {
  make();
  if (HasFatalFailure()) return;
  std::filesystem::create_directory(folder_ / "alone");
  std::filesystem::copy_file(program_, folder_ / "alone/touchstone");
  const Outcome alone =
      testing::run_command("PATH=/usr/bin:/bin ./alone/touchstone check --golden golden --out left", folder_);
  EXPECT_EQ(alone.status, 1) << alone.out << alone.err;
  EXPECT_THAT(alone.out, HasSubstr("touchstone-loop is neither beside this program nor on PATH"));
  // A golden of a replay says nothing of a loop, and a device without a mass has no one run.
  change_case([](nlohmann::json& document) { document["loop"]["device"] = "omega.3"; });
  EXPECT_THAT(check("").out, HasSubstr("mass"));
  change_case([](nlohmann::json& document) { document["loop"]["device"] = "no-such"; });
  EXPECT_THAT(check("").out, HasSubstr("no-such"));
  change_case([](nlohmann::json& document) { document["loop"]["device"] = "../touch-x.json"; });
  EXPECT_EQ(check("").status, 3);
  change_case([](nlohmann::json& document) { document.erase("loop"); });
  EXPECT_EQ(check("--model calm").status, 1);
}

}  // namespace
}  // namespace touchstone::loop
