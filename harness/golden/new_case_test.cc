#include "harness/golden/new_case.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/temporary_folder.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace touchstone::golden {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class NewGoldenCase : public ::testing::Test {
 protected:
  void SetUp() override {
    // A plate of 40 mm, and a stroke that presses 1 mm deep.
    write_file(folder_ / "plate.obj", "v -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\nf 1 2 3\nf 1 3 4\n");
    recording::InTrajectory path;
    for (int i = 0; i < 500; ++i) {
      path.motion.t_s.push_back(1e-3 * i);
      path.motion.p_W_m.emplace_back(0.01 - 2e-5 * i, 0.003, 0.002 - 0.003 * std::sin(3.14159 * i / 500.0));
    }
    save_trajectory(folder_ / "path.csv", path);
    write_file(
        folder_ / "god-object.json",
        R"({"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {"stiffness_N_per_m": 500}})");
    wanted_.name = "plate-stroke";
    wanted_.mesh = folder_ / "plate.obj";
    wanted_.mesh_unit = "mm";
    wanted_.trajectory = folder_ / "path.csv";
    wanted_.models = {folder_ / "god-object.json"};
  }
  MadeCase make() const { return make_case(catalogues_, folder_ / "golden", wanted_); }
  [[nodiscard]] std::string complaint() const {
    try {
      make();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  testing::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path();
  Catalogues catalogues_{renderers::built_in_catalogue(), synthetic::built_in_generators()};
  NewCase wanted_;
};

TEST_F(NewGoldenCase, RunsAtOnceAndHasAToleranceWithItsReason) {
  const MadeCase made = make();
  // 500 N/m x 1 mm; rounding moves a plane's force by rounding of 10 mm x 500 N/m.
  EXPECT_NEAR(made.largest_N, 0.5, 1e-3);
  EXPECT_GT(made.rounding_N, 0.0);
  EXPECT_LT(made.rounding_N, 1e-12);
  EXPECT_THAT(made.golden.tolerance.reason, HasSubstr("units in the last place"));
  const CaseRun run = run_case(catalogues_, load_case(folder_ / "golden" / "plate-stroke"), "god-object", false);
  EXPECT_EQ(run.rendered.f_W_N.size(), 500U);
}

TEST_F(NewGoldenCase, AMeshInAnotherUnitIsRefusedWithTheOneThatFits) {
  // A closed box of 40 mm, touched at its top; read as metres the path is deep within it.
  recording::InTrajectory top = recording::load_trajectory(folder_ / "path.csv");
  for (Vec3& p : top.motion.p_W_m) p.z() += 0.02;
  save_trajectory(folder_ / "top.csv", top);
  wanted_.trajectory = folder_ / "top.csv";
  std::string box;
  for (int i = 0; i < 8; ++i)
    box += fmt::format("v {} {} {}\n", (i & 1) != 0 ? 20 : -20, (i & 2) != 0 ? 20 : -20, (i & 4) != 0 ? 20 : -20);
  for (const char* const face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"})
    box += fmt::format("f {}\n", face);
  write_file(folder_ / "box.obj", box);
  wanted_.mesh = folder_ / "box.obj";
  wanted_.mesh_unit = "m";
  EXPECT_THAT(complaint(), HasSubstr("--mesh-unit mm"));
  EXPECT_FALSE(fs::exists(folder_ / "golden" / "plate-stroke")) << "nothing is left behind";
  wanted_.mesh_unit = "mm";
  EXPECT_EQ(complaint(), "");
}

TEST_F(NewGoldenCase, ItsLimitsChangeWithTheirReasonOrNotAtAll) {
  const fs::path folder = make().golden.folder;
  const auto lines = edit_tolerance(folder, {"force.atol_N=2e-5", "contact_position.rtol="}, "a coarser solver");
  EXPECT_THAT(lines,
              ::testing::ElementsAre("force.atol_N: 1e-06 -> 2e-05", "contact_position.rtol: 1e-06 -> not given"));
  const GoldenCase changed = load_case(folder);
  EXPECT_EQ(changed.tolerance.of("force").atol, 2e-5);
  EXPECT_EQ(changed.tolerance.reason, "a coarser solver");
  const std::string before = read_file(folder / "case.json");
  for (const char* const wrong : {"force.atol=2e-5", "froce.atol_N=1", "force.atol_N=-1", "force.atol_N=much", "force"})
    EXPECT_THROW(edit_tolerance(folder, {wrong}, "why"), Error) << wrong;
  EXPECT_THROW(edit_tolerance(folder, {"force.atol_N=1"}, " "), UsageError);
  EXPECT_EQ(read_file(folder / "case.json"), before);
}

// From a folder below as from the top, and never below a folder that is there already.
TEST_F(NewGoldenCase, GoesIntoTheFolderThatIsFoundUpwards) {
  const fs::path here = fs::current_path();
  fs::create_directories(folder_ / "top/.git");
  fs::create_directories(folder_ / "top/src/deep");
  fs::current_path(folder_ / "top/src/deep");
  EXPECT_EQ(own_golden_folder("golden"), "../../golden");
  fs::create_directories(folder_ / "top/src/golden");
  EXPECT_EQ(own_golden_folder("golden"), "../golden");
  EXPECT_EQ(own_golden_folder(folder_ / "elsewhere"), folder_ / "elsewhere");
  fs::current_path(here);
}

TEST_F(NewGoldenCase, TakesAPartOfThePath) {
  wanted_.from_s = 0.1;
  wanted_.to_s = 0.2;
  const MadeCase made = make();
  EXPECT_EQ(recording::load_trajectory(made.golden.trajectory.file).size(), 101U);
}

TEST_F(NewGoldenCase, LeavesNothingBehindIfItCannotRun) {
  wanted_.from_s = 7.0;
  wanted_.to_s = 8.0;
  EXPECT_THAT(complaint(), HasSubstr("there are 0 samples"));
  wanted_.from_s = wanted_.to_s = 0.0;
  write_file(folder_ / "god-object.json", R"({"schema": "touchstone-model/1", "renderer": "god-objekt"})");
  EXPECT_THAT(complaint(), HasSubstr("god-objekt"));
  wanted_.name = "Plate Stroke";
  EXPECT_THAT(complaint(), HasSubstr("lower-case"));
  EXPECT_FALSE(fs::exists(folder_ / "golden" / "plate-stroke"));
}

// Along the plate's very border a tip is on it or beside it by the last bit.
TEST_F(NewGoldenCase, RefusesAPathOnWhichRoundingDecides) {
  recording::InTrajectory path = recording::load_trajectory(folder_ / "path.csv");
  for (Vec3& p : path.motion.p_W_m) p = Vec3(0.02, p.y(), p.z());
  save_trajectory(folder_ / "border.csv", path);
  wanted_.trajectory = folder_ / "border.csv";
  EXPECT_THAT(complaint(), HasSubstr("rounding alone changes the force"));
  EXPECT_FALSE(fs::exists(folder_ / "golden" / "plate-stroke"));
}

TEST_F(NewGoldenCase, ReplacesNoCase) {
  make();
  EXPECT_THAT(complaint(), HasSubstr("is there already"));
}

}  // namespace
}  // namespace touchstone::golden
