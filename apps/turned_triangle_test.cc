// A mesh with one triangle turned inside out, in every command that renders over it: what it is told, and what --repair
// and --two-sided make of it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;

constexpr const char* expected_warning = "turned.obj: inconsistent-orientation: 1 triangles";
constexpr const char* turned = "repaired: 1 of 12 triangles turned";

class TurnedTriangle : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    testing::BuiltProgram::SetUp();
    if (IsSkipped()) return;
    // A block 40 mm wide with its top at z = 0. The fourth triangle, of the top, faces down.
    std::string block;
    for (const double z : {-0.02, 0.0})
      for (const double y : {-0.02, 0.02})
        for (const double x : {-0.02, 0.02}) block += fmt::format("v {} {} {}\n", x, y, z);
    block +=
        "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";
    write_file(folder_ / "turned.obj", block);
    write_file(
        folder_ / "model.json",
        R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": 500}})");
    // Down to 0.5 mm on the right half of the top, and over its diagonal to the other, with the force of a whole block
    // and some noise.
    std::string rows = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int n = 0; n < 1000; ++n) {
      const double z = std::max(-5e-4, 1e-3 - 1e-5 * n);
      const double along = 1.5e-5 * std::max(0, n - 200) - 6e-3;
      rows += fmt::format("{},{},{},{},0,0,{}\n", 1e-3 * n, -along, along, z,
                          std::max(0.0, -500.0 * z) + 1e-3 * std::sin(12.9898 * n));
    }
    write_file(folder_ / "over.csv", rows);
  }

  // The text of what is said of the mesh, on either stream.
  std::string said(const std::string& command) const {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.err;
    return outcome.out + outcome.err;
  }
  [[nodiscard]] double last_force_N(const std::string& options) const {
    said("replay --model model.json --mesh turned.obj --trajectory over.csv --out out.csv " + options);
    const std::string rows = read_file(folder_ / "out.csv");
    const std::string last = rows.substr(rows.rfind('\n', rows.size() - 2) + 1);
    std::size_t at = 0;
    for (int comma = 0; comma < 6; ++comma) at = last.find(',', at) + 1;
    return std::stod(last.substr(at));
  }
};

TEST_F(TurnedTriangle, LetsTheTipThroughUntilItIsRepairedOrTwoSided) {
  EXPECT_EQ(last_force_N(""), 0.0);
  EXPECT_NEAR(last_force_N("--repair"), 0.25, 1e-12);
  EXPECT_NEAR(last_force_N("--two-sided"), 0.25, 1e-12);
}

TEST_F(TurnedTriangle, IsSaidByEveryCommand) {
  for (const std::string& command :
       {std::string("replay --model model.json --mesh turned.obj --trajectory over.csv --out out.csv"),
        std::string("evaluate --model model.json --recording over.csv --mesh turned.obj --in-trajectory measured "
                    "--metrics rms_force_error --out evaluated"),
        std::string("fit --parameter stiffness_N_per_m=100:5000 --model model.json --recording over.csv --mesh "
                    "turned.obj --in-trajectory measured --out fitted"),
        std::string("discrepancy --time-limit 1 --model model.json --recording over.csv --mesh turned.obj --out "
                    "searched"),
        std::string("discrepancy --verify --model model.json --recording over.csv --mesh turned.obj")}) {
    EXPECT_THAT(said(command), AllOf(HasSubstr(expected_warning), Not(HasSubstr(turned)))) << command;
    EXPECT_THAT(said(command + " --repair"), AllOf(Not(HasSubstr(expected_warning)), HasSubstr(turned))) << command;
  }
}

// The run that makes sure of the written model reads the files once more, and does not say it again.
TEST_F(TurnedTriangle, IsSaidOnceByASearch) {
  const std::string text =
      said("discrepancy --time-limit 1 --model model.json --recording over.csv --mesh turned.obj --out searched");
  EXPECT_EQ(text.find(expected_warning), text.rfind(expected_warning)) << text;
}

TEST_F(TurnedTriangle, OfAGoldenCasesOwnFileIsSaidByCheck) {
  std::filesystem::create_directories(folder_ / "golden/block");
  std::filesystem::copy_file(folder_ / "turned.obj", folder_ / "golden/block/turned.obj");
  write_file(folder_ / "golden/block/case.json", R"({"schema": "touchstone-golden-case/1", "name": "block",
    "summary": "taps on a block", "surface": {"mesh": "turned.obj", "unit": "m"},
    "trajectory": {"name": "taps", "parameters": {"height_m": 0.001, "depth_m": 0.001, "period_s": 0.4, "taps": 1},
                   "seed": 1, "rate_Hz": 1000, "offset_m": [0.006, -0.006, 0]},
    "scale": 1, "speed": 1,
    "models": {"god-object": {"schema": "touchstone-model/1", "renderer": "god-object",
                              "parameters": {"stiffness_N_per_m": 500}}},
    "tolerance": {"reason": "none is needed", "force": {"atol_N": 1e-9}}, "jnd_share": 0.05})");
  const Outcome check = run("check block --golden golden --out failures");
  EXPECT_EQ(check.status, 1) << "there is no golden yet: " << check.err;
  EXPECT_THAT(check.err, HasSubstr(expected_warning));
}

}  // namespace
}  // namespace touchstone::apps
