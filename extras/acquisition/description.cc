#include "description.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/json_reader.h"

namespace touchstone::acquisition {
namespace {

Vec3 vector_of(JsonObject& object, std::string_view key) {
  const auto v = object.numbers(key);
  if (v.size() != 3) object.fail_at(key, "three numbers were expected");
  return {v[0], v[1], v[2]};
}

Vec3 direction_of(JsonObject& object, std::string_view key) {
  const Vec3 v = vector_of(object, key);
  if (!(v.norm() > 0.0)) object.fail_at(key, "a direction was expected, not zero");
  return v.normalized();
}

double positive(JsonObject& object, std::string_view key, double otherwise) {
  const double value = object.optional_number(key).value_or(otherwise);
  if (!(value > 0.0)) object.fail_at(key, "a positive number was expected");
  return value;
}

}  // namespace

AcquisitionDescription read_description(const std::filesystem::path& path, const std::optional<RawStreams>& streams) {
  const auto json = load_json(path);
  AcquisitionDescription d;
  d.file = path;
  const auto beside = [&](const std::string& name) { return path.parent_path() / name; };
  JsonObject root(json, path.string(), "");
  root.schema("touchstone-acquisition/1");
  auto force = root.object("force");
  // A file that is named beside recorded streams is left over from another session: it is refused as unknown.
  d.force_file = streams ? streams->force : beside(force.text("file"));
  if (const auto file = force.optional_text("calibration")) d.calibration_file = beside(*file);
  d.serial = force.optional_text("serial").value_or("");
  if (force.has("bias_from_s"))
    d.bias = AcquisitionDescription::Interval{force.number("bias_from_s"), force.number("bias_to_s")};
  if (d.bias && !(d.bias->to_s > d.bias->from_s)) force.fail_at("bias_to_s", "must be later than bias_from_s");
  d.force_cutoff_Hz = positive(force, "cutoff_Hz", d.force_cutoff_Hz);
  force.finish();

  auto motion = root.object("motion");
  d.motion_file = streams ? streams->motion : beside(motion.text("file"));
  d.largest_gap_s = positive(motion, "largest_gap_s", d.largest_gap_s);
  d.keep_around_gaps = motion.optional_flag("keep_around_gaps").value_or(false);
  if (motion.has("cutoff_Hz")) d.motion_cutoff_Hz = positive(motion, "cutoff_Hz", 1.0);
  motion.finish();

  auto probe = root.object("probe");
  d.tip_P_m = vector_of(probe, "tip_P_m");
  d.tip_S_m = vector_of(probe, "tip_S_m");
  d.tip_radius_m = probe.optional_number("tip_radius_m").value_or(0.0);
  if (!(d.tip_radius_m >= 0.0)) probe.fail_at("tip_radius_m", "must not be negative");
  if (probe.has("q_PS")) {
    const auto q = probe.numbers("q_PS");
    if (q.size() != 4) probe.fail_at("q_PS", "four numbers were expected: qw, qx, qy, qz");
    d.q_PS = Quat(q[0], q[1], q[2], q[3]);
    if (!(std::abs(d.q_PS.norm() - 1.0) < 1e-3)) probe.fail_at("q_PS", "is not a unit quaternion (qw, qx, qy, qz)");
    d.q_PS.normalize();
  }
  probe.finish();

  if (root.has("tool")) {
    auto tool = root.object("tool");
    if (tool.has("file")) {
      d.tool_file = beside(tool.text("file"));
      if (tool.has("mass_kg")) d.weighed_kg = positive(tool, "mass_kg", 1.0);
    } else {
      ToolLoad load;
      load.mass_kg = tool.number("mass_kg");
      if (!(load.mass_kg >= 0.0)) tool.fail_at("mass_kg", "a mass of zero or more was expected");
      load.center_S_m = vector_of(tool, "center_S_m");
      if (tool.has("bias_N")) load.bias.f_N = vector_of(tool, "bias_N");
      if (tool.has("bias_Nm")) load.bias.torque_Nm = vector_of(tool, "bias_Nm");
      d.tool = load;
    }
    if (tool.has("gravity_T_m_per_s2")) d.gravity_T_m_per_s2 = vector_of(tool, "gravity_T_m_per_s2");
    tool.finish();
  }
  if (root.has("clocks")) {
    auto clocks = root.object("clocks");
    if (clocks.has("offset_s")) {
      d.align_taps = false;
      d.known_offset_s = clocks.number("offset_s");
    } else {
      if (clocks.has("tap_normal_W")) d.tap_normal_W = direction_of(clocks, "tap_normal_W");
      d.taps.force_threshold_N = clocks.optional_number("tap_threshold_N").value_or(0.0);
      d.taps.longest_tap_s = positive(clocks, "longest_tap_s", d.taps.longest_tap_s);
    }
    clocks.finish();
  }
  if (root.has("registration")) {
    auto registration = root.object("registration");
    d.markers_file = beside(registration.text("markers"));
    if (const auto mesh = registration.optional_text("mesh")) d.mesh_file = beside(*mesh);
    d.mesh_unit = registration.optional_text("mesh_unit").value_or("m");
    d.contact_force_N = positive(registration, "contact_force_N", d.contact_force_N);
    d.largest_marker_residual_m = positive(registration, "largest_marker_residual_m", d.largest_marker_residual_m);
    registration.finish();
  }
  root.finish();
  return d;
}

}  // namespace touchstone::acquisition
