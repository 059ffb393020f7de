// Two files against each other: what passes, what explains a failure, and the floor of a repeat.
#include "harness/golden/comparison/compared_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::golden {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class Compared : public ::testing::Test {
 protected:
  // Presses of a spring with the sensor's noise; the force times `sign`, more by `bias_N`.
  std::filesystem::path presses(const std::string& name, std::uint64_t seed, double noise_N, double sign = 1.0,
                                double bias_N = 0.0) {
    Random random(seed);
    std::string text = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = i / 200.0, depth = 0.002 * (1.0 - std::cos(3.0 * t));
      const double x = 0.01 * std::sin(0.7 * t);
      text += fmt::format("{:.4f},{:.9f},0,{:.9f},{:.6f},{:.6f},{:.6f}\n", t, x, -depth, noise_N * random.normal(),
                          noise_N * random.normal(), sign * (800.0 * depth + bias_N) + noise_N * random.normal());
    }
    write_file(folder_.path() / name, text);
    return folder_.path() / name;
  }
  testing::TemporaryFolder folder_;
};

TEST_F(Compared, TheSameFilePasses) {
  const auto file = presses("a.csv", 1, 0.02);
  const ComparedFiles files = compare_files({file, file, {}, {}, false});
  EXPECT_TRUE(files.passed);
  EXPECT_EQ(files.metric("force_rms_N"), 0.0);
  EXPECT_THAT(files.explanations(), IsEmpty());
  EXPECT_THAT([&] { static_cast<void>(files.metric("taste")); }, ThrowsMessage<BadData>(HasSubstr("force_rms_N")));
}

TEST_F(Compared, AReversedForceIsExplainedAndPassesFlipped) {
  const auto right = presses("right.csv", 2, 0.0), reversed = presses("reversed.csv", 2, 0.0, -1.0);
  const ComparedFiles files = compare_files({right, reversed, {}, {}, false});
  EXPECT_FALSE(files.passed);
  ASSERT_FALSE(files.explanations().empty());
  EXPECT_THAT(files.explanations().front(), HasSubstr("reversed"));
  EXPECT_TRUE(compare_files({right, reversed, {}, {}, true}).passed);
}

TEST_F(Compared, AnErrorWithinTheFloorOfARepeatPassesUnlessATolerancesIsGiven) {
  const auto first = presses("first.csv", 3, 0.02), again = presses("again.csv", 4, 0.02);
  const auto rendered = presses("rendered.csv", 3, 0.02, 1.0, 0.001);
  CompareRequest request{first, rendered, again, {}, false};
  const ComparedFiles files = compare_files(request);
  ASSERT_TRUE(files.floor.has_value());
  EXPECT_TRUE(files.within_floor);
  EXPECT_TRUE(files.passed);
  EXPECT_THAT(files.text(), HasSubstr("repeat floor:"));
  EXPECT_EQ(nlohmann::json::parse(files.json())["repeat_floor"]["within"], true);
  request.tolerance = default_tolerance();
  EXPECT_FALSE(compare_files(request).passed) << "who gives a tolerance means it";
  // An error above what the thing itself has.
  EXPECT_FALSE(compare_files({first, presses("off.csv", 3, 0.02, 1.0, 0.2), again, {}, false}).passed);
}

TEST_F(Compared, ColumnsWithoutForceAreNoRecording) {
  TrajectoryColumns columns;
  columns.source = "empty";
  EXPECT_EQ(recording_of(columns).size(), 0U);
}

TEST_F(Compared, AnOrientationThatIsShorterIsNone) {
  TrajectoryColumns columns;
  columns.source = "short";
  for (const char* const name : {"t", "x", "y", "z", "fx", "fy", "fz"}) columns.columns.push_back({name, {0.0, 1.0}});
  for (const char* const name : {"qw", "qx", "qy", "qz"}) columns.columns.push_back({name, {1.0}});
  const recording::Recording recording = recording_of(columns);
  EXPECT_EQ(recording.size(), 2U);
  EXPECT_TRUE(recording.motion.q_WS.empty());
}

}  // namespace
}  // namespace touchstone::golden
