// Sixty seconds of a peg in a hole, against forces and torques that were accepted: golden/ beside this file. They are
// made by, and only on purpose:
//   touchstone tool case peg-0.2mm --out peg
//   touchstone tool replay --renderer NAME --tool peg/tool.obj --object peg/object.obj --path peg/path.csv
//     --keep-every 200 --out renderers/tool/golden/peg-0.2mm.NAME.csv
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "harness/recording/recording_file.h"
#include "harness/tool/tool_metrics.h"
#include "renderers/tool/tool_catalogue.h"
#include "synthetic/tool/scripted_path.h"

namespace touchstone::renderers {
namespace {

class ToolGolden : public ::testing::TestWithParam<std::string> {};

TEST_P(ToolGolden, SixtySecondsOfAPegInAHole) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  if (source == nullptr) GTEST_SKIP() << "TOUCHSTONE_SOURCE_DIR does not say where the golden files are";
  const auto file = std::filesystem::path(source) / "renderers/tool/golden" / ("peg-0.2mm." + GetParam() + ".csv");
  const Recording golden = load_recording(file);
  const synthetic::ExactCase c = synthetic::make_exact_case("peg-0.2mm");
  constexpr double kDuration_s = 60.0;
  constexpr std::size_t kSteps = 60001;
  constexpr std::size_t kEvery = 200;
  ASSERT_EQ(golden.size(), kSteps / kEvery + 1);
  const auto renderer = make_tool_renderer(GetParam(), {c.tool_T, solid_mass_frame(c.tool_T, 1000.0)}, c.object_W, {});
  Recording obtained;
  obtained.source = GetParam();
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double t_s = double(i) / 1000.0;
    const Pose handle = synthetic::scripted_pose(c, t_s, kDuration_s);
    const ToolResult result = renderer->step({t_s, handle});
    if (i % kEvery != 0) continue;
    obtained.motion.t_s.push_back(t_s);
    obtained.motion.p_W_m.push_back(handle.p_W_m);
    obtained.f_W_N.push_back(result.f_W_N);
    obtained.torque_W_Nm.push_back(result.torque_W_Nm);
  }
  const ToolComparison comparison = compare_tools(golden, obtained);
  // As for points: far below what a sensor resolves, far above rounding on one architecture. Per axis.
  for (int k = 0; k < 3; ++k) {
    EXPECT_LE(comparison.max_force_error_N[k], 1e-6);
    EXPECT_LE(comparison.max_torque_error_Nm[k], 1e-7);
  }
  double largest = 0.0;
  for (const Vec3& torque : golden.torque_W_Nm) largest = std::max(largest, torque.norm());
  EXPECT_GT(largest, 0.02) << "the golden has torques worth comparing";
}

INSTANTIATE_TEST_SUITE_P(Tools, ToolGolden,
                         ::testing::Values("god-object-tool", "voxmap-pointshell", "penalty-coupling"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace touchstone::renderers
