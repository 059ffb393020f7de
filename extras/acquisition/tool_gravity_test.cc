// A robot's tool on a force sensor, real data: 24 static orientations and one moving run in free air with three clocks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "free_air_files.h"
#include "harness/recording/raw_table.h"
#include "harness/testing/shared_data.h"

namespace touchstone::acquisition {
using recording::RawTable;
using recording::StaticPose;
namespace {

const Vec3 gravity(0, 0, -9.82085);  // as the data's own gravity column has it

struct Statics {
  std::vector<StaticPose> poses;
  std::vector<Quat> q_WS;
  std::vector<Vec3> acceleration;
};

Statics load_statics(const std::filesystem::path& path) {
  const RawTable table(path);
  Statics s;
  s.q_WS = table.rotations();
  s.acceleration = table.vectors("a", {}, true);
  const auto f = table.vectors("f", {}, true), torque = table.vectors("t", {}, true);
  for (std::size_t i = 0; i < table.rows(); ++i) s.poses.push_back({s.q_WS[i], {f[i], torque[i]}});
  return s;
}

TEST(ToolGravity, StaticResidualOfARealToolIsSmall) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(path, "tool-gravity/0-calibration_fts-accel.csv");
  const auto statics = load_statics(path);
  ASSERT_EQ(statics.poses.size(), 24U);
  const auto found = recording::identify_tool(statics.poses, gravity, "statics");
  fmt::print(
      "mass {:.4f} +- {:.4f} kg; force residual {:.4f} N RMS per component ({:.4f} N as a vector), held out {:.4f} N; "
      "torque {:.5f} N m\n",
      found.load.mass_kg, found.mass_sigma_kg, found.fit.force_component_N, found.fit.force_vector_N,
      found.held_out.force_component_N, found.fit.torque_component_Nm);
  EXPECT_LE(found.fit.force_component_N, 0.09);
  EXPECT_LE(found.held_out.force_component_N, 0.10);
  EXPECT_GT(found.held_out.force_component_N, found.fit.force_component_N);
  EXPECT_NEAR(found.load.mass_kg, 0.932, 4 * found.mass_sigma_kg);
  // The residual belongs to the arm's whole pose, not to gravity: the same pose taken twice errs alike, the same
  // gravity in another pose does not. So no model of weight and mounting removes it.
  const auto error = [&](std::size_t i) -> Vec3 {
    return statics.poses[i].measured.f_N - recording::tool_wrench(found.load, statics.q_WS[i], gravity).f_N;
  };
  ASSERT_LT(statics.q_WS[0].angularDistance(statics.q_WS[18]), 1e-3);
  EXPECT_LT((error(0) - error(18)).norm(), 0.1);
  EXPECT_GT((error(0) - error(4)).norm(), 0.3);
}

TEST(ToolGravity, FreeAirResidualIsBiasInertiaAndVibration) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(calibration, "tool-gravity/0-calibration_fts-accel.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(wrench_path, "tool-gravity/1-baseline_wrench.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(orientation_path, "tool-gravity/1-baseline_orientations.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(acceleration_path, "tool-gravity/1-baseline_accel.csv");
  FreeAirFiles files{calibration, wrench_path, orientation_path, acceleration_path, "us", true, -gravity.z()};
  const auto result = read_and_analyse_free_air(files);
  const auto& report = result.report;
  fmt::print("{}", free_air_text(result));
  EXPECT_LT(*result.accelerometer_residual_m_per_s2, 0.05);
  ASSERT_EQ(report.bands.size(), 4U);
  // Slow motion: the inertia of the mass found at rest explains most of what moves; the sensor's bias has shifted.
  EXPECT_LT(report.bands[0].inertia_removed_N, 0.4 * report.bands[0].bias_removed_N);
  EXPECT_GT(report.bias_shift_N.norm(), 0.1);
  // Most of the unsmoothed residual is faster than 20 Hz: vibration, which the accelerometer feels elsewhere on the
  // tool.
  EXPECT_GT(report.bands[3].bias_removed_N, 1.5 * report.bands[2].bias_removed_N);
  EXPECT_GT(report.bands[3].inertia_removed_N, report.bands[0].inertia_removed_N);
  // Nor is it the mass or the clocks: fitted to the slow motion, the mass is the static one's, the clocks agree within
  // 10 ms, and next to nothing is gained.
  for (const std::size_t slow : {0U, 1U}) {
    EXPECT_NEAR(report.bands[slow].fitted_mass_kg, result.tool.load.mass_kg, 0.05 * result.tool.load.mass_kg);
    EXPECT_LT(std::abs(report.bands[slow].fitted_offset_s), 0.0101);
    EXPECT_GT(report.bands[slow].fitted_removed_N, 0.8 * report.bands[slow].inertia_removed_N);
  }
  files.acceleration.reset();
  const auto without = read_and_analyse_free_air(files);
  EXPECT_TRUE(std::isnan(without.report.bands[0].fitted_mass_kg));
  EXPECT_NEAR(without.report.raw.force_vector_N, report.raw.force_vector_N, 0.05);
}

}  // namespace
}  // namespace touchstone::acquisition
