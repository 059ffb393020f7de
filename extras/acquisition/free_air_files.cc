#include "free_air_files.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/recording/ati_calibration.h"
#include "harness/recording/raw_table.h"

namespace touchstone::acquisition {
using recording::force_units;
using recording::RawTable;
using recording::torque_units;
namespace {

std::vector<Wrench> wrenches(const RawTable& table, bool bare_is_si) {
  const auto f = table.vectors("f", force_units, bare_is_si), t = table.vectors("t", torque_units, bare_is_si);
  std::vector<Wrench> list;
  list.reserve(f.size());
  for (std::size_t i = 0; i < f.size(); ++i) list.push_back({f[i], t[i]});
  return list;
}

nlohmann::json number(double v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(); }

}  // namespace

FreeAirResult read_and_analyse_free_air(const FreeAirFiles& files) {
  const Vec3 gravity(0, 0, -files.gravity_m_per_s2);
  const RawTable statics(files.statics), wrench(files.wrench), orientation(files.orientation);
  const auto static_wrench = wrenches(statics, files.bare_is_si);
  const auto static_q = statics.rotations();
  std::vector<StaticPose> poses;
  poses.reserve(static_q.size());
  for (std::size_t i = 0; i < static_q.size(); ++i) poses.push_back({static_q[i], static_wrench[i]});
  FreeAirResult result;
  result.tool = recording::identify_tool(poses, gravity, statics.source());

  FreeAirRun run;
  run.t_wrench_s = wrench.times_s(files.time_unit);
  run.wrench = wrenches(wrench, files.bare_is_si);
  run.t_orientation_s = orientation.times_s(files.time_unit);
  run.q_WS = orientation.rotations();
  AccelerometerMap accelerometer;
  if (files.acceleration) {
    accelerometer = identify_accelerometer(statics.vectors("a", {}, true), static_q, gravity, statics.source());
    result.accelerometer_residual_m_per_s2 = accelerometer.residual_m_per_s2;
    const RawTable acceleration(*files.acceleration);
    run.t_acceleration_s = acceleration.times_s(files.time_unit);
    run.acceleration = acceleration.vectors("a", {}, true);
  }
  // Clocks of the day lose digits.
  const double start = run.t_wrench_s.front();
  for (auto* clock : {&run.t_wrench_s, &run.t_orientation_s, &run.t_acceleration_s}) {
    for (double& t : *clock) t -= start;
  }
  result.report =
      analyse_free_air(run, result.tool.load, accelerometer, gravity, {2, 5, 20, 100}, 0.02, wrench.source());
  return result;
}

std::string free_air_text(const FreeAirResult& result) {
  const auto& t = result.tool;
  const auto& r = result.report;
  std::string text = fmt::format(
      "at rest, calibration  {:.4f} N RMS per component ({:.4f} N as a vector), held out {:.4f} N; tool {:.4f} +- "
      "{:.4f} kg\n",
      t.fit.force_component_N, t.fit.force_vector_N, t.held_out.force_component_N, t.load.mass_kg, t.mass_sigma_kg);
  text += fmt::format("moving, free air      {:.3f} N RMS per component ({:.3f} N as a vector)\n",
                      r.raw.force_component_N, r.raw.force_vector_N);
  text += fmt::format(
      "  while it rests ({:.0f} % of the run) {:.3f} N as a vector; the bias has moved by {:.3f} {:.3f} {:.3f} N\n",
      100 * r.rest_fraction, r.at_rest.force_vector_N, r.bias_shift_N.x(), r.bias_shift_N.y(), r.bias_shift_N.z());
  if (result.accelerometer_residual_m_per_s2)
    text += fmt::format("  accelerometer against gravity at rest {:.4f} m/s^2 RMS\n",
                        *result.accelerometer_residual_m_per_s2);
  text +=
      "  below      weight     and this    and m a of the   with the best mass and clock offset\n"
      "             removed    run's bias  static mass\n";
  double share_below = 0.0;
  for (const auto& band : r.bands) {
    text += fmt::format("  {:5.0f} Hz   {:6.3f} N   {:6.3f} N    ", band.cutoff_Hz, band.weight_removed_N,
                        band.bias_removed_N);
    text += std::isfinite(band.inertia_removed_N)
                ? fmt::format("{:6.3f} N         {:6.3f} N ({:.3f} kg, {:+.0f} ms)\n", band.inertia_removed_N,
                              band.fitted_removed_N, band.fitted_mass_kg, 1e3 * band.fitted_offset_s)
                : "     -              -\n";
    if (band.cutoff_Hz == 20.0) share_below = std::pow(band.weight_removed_N / r.raw.force_vector_N, 2);
  }
  if (share_below > 0.0)
    text += fmt::format("  faster than 20 Hz (vibration): {:.0f} % of the square\n", 100 * (1.0 - share_below));
  if (!r.contacts.empty()) text += "  " + contact_message(r, "the run") + "\n";
  return text;
}

std::string free_air_json(const FreeAirResult& result) {
  const auto& r = result.report;
  nlohmann::json j{{"schema", "touchstone-free-air/1"},
                   {"static_force_component_rms_N", result.tool.fit.force_component_N},
                   {"static_held_out_component_rms_N", result.tool.held_out.force_component_N},
                   {"tool_mass_kg", result.tool.load.mass_kg},
                   {"moving_force_vector_rms_N", r.raw.force_vector_N},
                   {"moving_force_component_rms_N", r.raw.force_component_N},
                   {"at_rest_force_vector_rms_N", number(r.at_rest.force_vector_N)},
                   {"rest_fraction", r.rest_fraction},
                   {"bias_shift_N", {r.bias_shift_N.x(), r.bias_shift_N.y(), r.bias_shift_N.z()}},
                   {"contacts", nlohmann::json::array()},
                   {"bands", nlohmann::json::array()}};
  for (const auto& c : r.contacts) {
    j["contacts"].push_back({{"from_s", c.from_s}, {"to_s", c.to_s}, {"force_N", c.force_N}});
  }
  for (const auto& b : r.bands) {
    j["bands"].push_back({{"cutoff_Hz", b.cutoff_Hz},
                          {"weight_removed_N", b.weight_removed_N},
                          {"bias_removed_N", b.bias_removed_N},
                          {"inertia_removed_N", number(b.inertia_removed_N)},
                          {"fitted_mass_kg", number(b.fitted_mass_kg)},
                          {"fitted_offset_s", number(b.fitted_offset_s)},
                          {"fitted_removed_N", number(b.fitted_removed_N)}});
  }
  return j.dump(1) + "\n";
}

}  // namespace touchstone::acquisition
