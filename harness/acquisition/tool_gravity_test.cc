// A robot's tool on a force sensor, real data: 24 static orientations and one moving run in free air with three clocks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/acquisition/free_air.h"
#include "harness/acquisition/raw_table.h"
#include "harness/testing/shared_data.h"

namespace touchstone {
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
  const auto found = identify_tool(statics.poses, gravity, "statics");
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
    return statics.poses[i].measured.f_N - tool_wrench(found.load, statics.q_WS[i], gravity).f_N;
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
  const auto statics = load_statics(calibration);
  const auto load = identify_tool(statics.poses, gravity, "statics").load;
  const auto accelerometer = identify_accelerometer(statics.acceleration, statics.q_WS, gravity, "statics");
  EXPECT_LT(accelerometer.residual_m_per_s2, 0.05);

  const RawTable wrench(wrench_path), orientation(orientation_path), acceleration(acceleration_path);
  FreeAirRun run;
  run.t_wrench_s = wrench.times_s("us");
  run.t_orientation_s = orientation.times_s("us");
  run.t_acceleration_s = acceleration.times_s("us");
  const double start = run.t_wrench_s.front();
  for (auto* clock : {&run.t_wrench_s, &run.t_orientation_s, &run.t_acceleration_s}) {
    for (double& t : *clock) t -= start;
  }
  const auto f = wrench.vectors("f", {}, true), torque = wrench.vectors("t", {}, true);
  for (std::size_t i = 0; i < f.size(); ++i) run.wrench.push_back({f[i], torque[i]});
  run.q_WS = orientation.rotations();
  run.acceleration = acceleration.vectors("a", {}, true);

  const auto report = analyse_free_air(run, load, accelerometer, gravity, {2, 5, 20, 100}, 0.02, "run");
  fmt::print(
      "free air: {:.3f} N RMS as a vector ({:.3f} per component); at rest ({:.0f} %) {:.3f} N, bias shift {:.3f} "
      "{:.3f} {:.3f} N\n",
      report.raw.force_vector_N, report.raw.force_component_N, 100 * report.rest_fraction,
      report.at_rest.force_vector_N, report.bias_shift_N.x(), report.bias_shift_N.y(), report.bias_shift_N.z());
  for (const auto& band : report.bands) {
    fmt::print("  below {:5.0f} Hz: {:.3f} N, less this run's bias {:.3f} N, less inertia {:.3f} N\n", band.cutoff_Hz,
               band.weight_removed_N, band.bias_removed_N, band.inertia_removed_N);
  }
  ASSERT_EQ(report.bands.size(), 4U);
  // Slow motion: the inertia of the mass found at rest explains most of what moves; the sensor's bias has shifted.
  EXPECT_LT(report.bands[0].inertia_removed_N, 0.4 * report.bands[0].bias_removed_N);
  EXPECT_GT(report.bias_shift_N.norm(), 0.1);
  // Most of the unsmoothed residual is faster than 20 Hz: vibration, which the accelerometer feels elsewhere on the
  // tool.
  EXPECT_GT(report.bands[3].bias_removed_N, 1.5 * report.bands[2].bias_removed_N);
  EXPECT_GT(report.bands[3].inertia_removed_N, report.bands[0].inertia_removed_N);
}

}  // namespace
}  // namespace touchstone
