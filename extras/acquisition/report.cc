// The acquisition's report for programs and for people.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "acquire.h"

namespace touchstone::acquisition {
namespace {

using nlohmann::json;

json array(const Vec3& v) { return json::array({v.x(), v.y(), v.z()}); }

json residual(const WrenchResidual& r) {
  return {{"samples", r.samples},
          {"force_component_rms_N", r.force_component_N},
          {"force_vector_rms_N", r.force_vector_N},
          {"force_axis_rms_N", array(r.force_axis_N)},
          {"torque_component_rms_Nm", r.torque_component_Nm}};
}

}  // namespace

std::string report_json(const AcquisitionReport& report) {
  json j{{"schema", "touchstone-acquisition-report/1"},
         {"force_samples",
          {{"total", report.force_samples.total},
           {"saturated", report.force_samples.saturated},
           {"out_of_range", report.force_samples.out_of_range}}},
         {"free_air", residual(report.free_air)},
         {"force_bandwidth_Hz", report.force_bandwidth_Hz},
         {"motion_bandwidth_Hz", report.motion_bandwidth_Hz},
         {"force_noise_gain", report.noise_gain},
         {"samples_without_tracking", report.samples_without_tracking},
         {"notes", report.notes}};
  for (const auto& [file, hash] : report.inputs) j["inputs"].push_back({{"file", file}, {"sha256", hash}});
  if (report.tool) {
    const auto& t = *report.tool;
    j["tool"] = {{"mass_kg", t.load.mass_kg},
                 {"mass_sigma_kg", t.mass_sigma_kg},
                 {"center_S_m", array(t.load.center_S_m)},
                 {"center_sigma_m", array(t.center_sigma_m)},
                 {"bias_N", array(t.load.bias.f_N)},
                 {"bias_Nm", array(t.load.bias.torque_Nm)},
                 {"condition", t.condition},
                 {"fit", residual(t.fit)},
                 {"held_out", residual(t.held_out)}};
  }
  if (report.gain_error) {
    j["gain_error_N"] = report.gain_error->error_N;
    j["gain_error_sigma_N"] = report.gain_error->sigma_N;
  }
  if (report.clocks) {
    const auto& c = *report.clocks;
    j["clocks"] = {{"offset_s", c.offset_s},
                   {"offset_sigma_s", c.offset_sigma_s},
                   {"reference_s", c.reference_s},
                   {"skew_ppm", c.skew * 1e6},
                   {"skew_sigma_ppm", c.skew_sigma * 1e6},
                   {"skew_fitted", c.skew_fitted},
                   {"taps", c.taps},
                   {"free_motion", c.free_motion},
                   {"residual_rms_s", c.residual_rms_s},
                   {"interval95_s", c.interval95_at(c.reference_s)}};
    for (const auto& e : c.events) {
      j["clocks"]["events"].push_back({{"force_s", e.force_s},
                                       {"motion_s", e.motion_s},
                                       {"sigma_s", e.sigma_s},
                                       {"residual_s", e.residual_s},
                                       {"kind", e.free_motion ? "free motion" : "tap"}});
    }
  }
  if (report.markers) {
    const auto& m = *report.markers;
    const auto& q = m.tracker_to_object.q;
    j["markers"] = {{"residual_rms_m", m.residual_rms_m},
                    {"residual_m", m.residual_m},
                    {"q", {q.w(), q.x(), q.y(), q.z()}},
                    {"t_m", array(m.tracker_to_object.t_m)}};
  }
  if (report.contacts) {
    const auto& c = *report.contacts;
    j["contacts"] = {{"rms_before_m", c.rms_before_m},
                     {"rms_after_m", c.rms_after_m},
                     {"determined_directions", c.determined_directions},
                     {"converged", c.converged},
                     {"correction_t_m", array(c.correction.t_m)},
                     {"residual_map_m", c.residual_after_m}};
    j["contacts"]["object_move_m"] = report.object_move->size_m;
    j["contacts"]["unnoticed_move_m"] = report.object_move->unnoticed_m;
    for (const Vec3& p : c.contact_W_m) j["contacts"]["contact_W_m"].push_back(array(p));
  }
  return j.dump(1);
}

std::string report_text(const AcquisitionReport& report) {
  std::string text = fmt::format("force        {} samples, {} saturated, {} out of range\n", report.force_samples.total,
                                 report.force_samples.saturated, report.force_samples.out_of_range);
  if (report.tool) {
    const auto& t = *report.tool;
    text += fmt::format("tool         {:.5g} +- {:.2g} kg, residual {:.3g} N RMS per component ({:.3g} N held out)\n",
                        t.load.mass_kg, t.mass_sigma_kg, t.fit.force_component_N, t.held_out.force_component_N);
  }
  if (report.gain_error && report.gains.determined)
    text +=
        fmt::format("gains        of the axes: the force may be off by {:.3g} +- {:.2g} N RMS (95 %; limit {:.2g} N)\n",
                    report.gain_error->error_N, 2.0 * report.gain_error->sigma_N, report.gain_error->limit_N);
  if (report.clocks) {
    const auto& c = *report.clocks;
    text += fmt::format(
        "clocks       offset {:.6f} +- {:.6f} s (95 %), skew {:.1f} +- {:.1f} ppm, {} taps, {} s of free motion, "
        "residual "
        "{:.3g} ms RMS\n",
        c.offset_s, c.interval95_at(c.reference_s), c.skew * 1e6, c.skew_sigma * 1e6, c.taps, c.free_motion,
        1e3 * c.residual_rms_s);
  }
  if (report.markers)
    text += fmt::format("markers      {} markers, residual {:.3g} mm RMS\n", report.markers->markers,
                        1e3 * report.markers->residual_rms_m);
  if (report.contacts) {
    const auto& c = *report.contacts;
    text += fmt::format(
        "contacts     {:.3g} mm RMS off the surface before, {:.3g} mm after; {} of 6 directions determined\n",
        1e3 * c.rms_before_m, 1e3 * c.rms_after_m, c.determined_directions);
  }
  text += fmt::format("free air     {:.3g} N RMS per component over {} samples\n", report.free_air.force_component_N,
                      report.free_air.samples);
  text += fmt::format("bandwidth    force {:.4g} Hz (-3 dB), motion {:.4g} Hz\n", report.force_bandwidth_Hz,
                      report.motion_bandwidth_Hz);
  for (const auto& note : report.notes) text += "note         " + note + "\n";
  return text;
}

std::string tool_text(const ToolIdentification& t, const ForceGains& gains, bool forces_fit) {
  std::string text;
  text += fmt::format("mass             {:.6g} +- {:.2g} kg\n", t.load.mass_kg, t.mass_sigma_kg);
  text += fmt::format("centre of mass   {:.6g} {:.6g} {:.6g} m (+- {:.2g} {:.2g} {:.2g})\n", t.load.center_S_m.x(),
                      t.load.center_S_m.y(), t.load.center_S_m.z(), t.center_sigma_m.x(), t.center_sigma_m.y(),
                      t.center_sigma_m.z());
  text += fmt::format("bias             {:.6g} {:.6g} {:.6g} N, {:.6g} {:.6g} {:.6g} N m\n", t.load.bias.f_N.x(),
                      t.load.bias.f_N.y(), t.load.bias.f_N.z(), t.load.bias.torque_Nm.x(), t.load.bias.torque_Nm.y(),
                      t.load.bias.torque_Nm.z());
  text += fmt::format("force residual   {:.4g} N RMS per component, {:.4g} N as a vector, {} orientations\n",
                      t.fit.force_component_N, t.fit.force_vector_N, t.fit.samples);
  text += fmt::format("held out         {:.4g} N RMS per component, {:.4g} N as a vector\n",
                      t.held_out.force_component_N, t.held_out.force_vector_N);
  text += fmt::format("torque residual  {:.4g} N m RMS per component\n", t.fit.torque_component_Nm);
  if (gains.determined && forces_fit) {
    const Vec3 own = gains.gains(std::nullopt), sigma = gains.sigmas();
    text += fmt::format("gains of the axes {:.4g} {:.4g} {:.4g} of the middle one (+- {:.2g} {:.2g} {:.2g})\n", own.x(),
                        own.y(), own.z(), sigma.x(), sigma.y(), sigma.z());
    return text;
  }
  const std::string why = forces_fit ? fmt::format("{} poses do not determine them", gains.poses)
                                     : "no tool fits the forces: correct first what the warning says";
  return text + fmt::format("gains of the axes cannot tell: {}; {}\n", why, gain_poses);
}

}  // namespace touchstone::acquisition
