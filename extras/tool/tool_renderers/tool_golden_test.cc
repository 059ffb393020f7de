// Sixty seconds of a peg in a hole, against forces and torques that were accepted: golden/ beside this file, which
// `touchstone tool golden --accept NAME --reason WHY` changes, and only on purpose.
#include "contacts/tool_golden.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "harness/recording/recording_file.h"
#include "tool_metrics.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_renderers {
namespace {

class ToolGolden : public ::testing::TestWithParam<std::string> {};

std::optional<contacts::ToolGolden> golden_of_the_peg() {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  if (source == nullptr) return {};
  return contacts::read_tool_golden(std::filesystem::path(source) / "extras/tool/golden/peg-0.2mm.json");
}

TEST_P(ToolGolden, SixtySecondsOfAPegInAHole) {
  const auto golden = golden_of_the_peg();
  if (!golden) GTEST_SKIP() << "TOUCHSTONE_SOURCE_DIR does not say where the golden files are";
  const recording::Recording expected = recording::load_recording(golden->answer(GetParam()));
  ASSERT_EQ(expected.size(), 301U) << "every 200th of 60 s at 1 kHz";
  const recording::Recording obtained =
      contacts::answer_now(*golden, find_tool_renderer(tool_renderer_catalogue(), GetParam()));
  const tool::ToolComparison comparison = tool::compare_tools(expected, obtained);
  EXPECT_TRUE(tool::within(comparison, golden->force_tolerance_N, golden->torque_tolerance_Nm))
      << comparison_to_text(comparison);
  double largest = 0.0;
  for (const Vec3& torque : expected.torque_W_Nm) largest = std::max(largest, torque.norm());
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
}  // namespace touchstone::tool_renderers
