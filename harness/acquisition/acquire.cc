#include "harness/acquisition/acquire.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/acquisition/frame_check.h"
#include "harness/acquisition/raw_table.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/units.h"
#include "harness/recording/ati_calibration.h"
#include "harness/stats/quantile.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::acquisition {
namespace {

const std::vector<std::pair<std::string, double>> length_units{{"m", 1.0}, {"mm", 1e-3}};

struct ForceStream {
  std::vector<double> t_s;
  std::vector<Wrench> wrench;  // sensor frame, bias of the gauges removed where there is an interval for it
};

struct MotionStream {
  std::vector<double> t_s;
  std::vector<Vec3> tip_T_m;
  std::vector<Quat> q_TS;
  std::vector<double> after_gap_s;  // the times at which tracking came back
  std::vector<std::pair<double, double>> gaps;
};

GaugeVoltages mean_volts(const RawTable& table, const std::vector<double>& t,
                         const AcquisitionDescription::Interval& interval) {
  GaugeVoltages mean{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < interval.from_s || t[i] > interval.to_s) continue;
    ++n;
    for (std::size_t k = 0; k < 6; ++k) mean[k] += table.column(fmt::format("v{}_V", k + 1))[i];
  }
  if (n < 10) {
    throw BadData(fmt::format(
        "{}: the bias interval {} to {} s holds {} samples; it must lie within {:.3f} to {:.3f} s of the force's clock",
        table.source(), interval.from_s, interval.to_s, n, t.front(), t.back()));
  }
  for (double& v : mean) v /= static_cast<double>(n);
  return mean;
}

// What the sensor itself said of its samples, as `touchstone hil record` and `touchstone import` write it.
void count_flags(const std::vector<double>& flags, const std::string& source, AcquisitionReport& report) {
  constexpr double most = std::numeric_limits<std::uint32_t>::max();
  std::size_t faulty = 0;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!(flags[i] >= 0.0 && flags[i] <= most && flags[i] == std::floor(flags[i])))
      throw BadData(fmt::format("{}: sample {}: flags {} is not a whole number from 0 on", source, i + 1, flags[i]));
    const auto bits = static_cast<std::uint32_t>(flags[i]);
    report.force_samples.saturated += (bits & sample_saturated) != 0;
    report.force_samples.out_of_range += (bits & sample_out_of_range) != 0;
    faulty += (bits & sample_device_error) != 0;
  }
  if (faulty > 0) {
    report.notes.push_back(
        fmt::format("of {} of {} force samples the sensor reported an error: their forces may mean "
                    "nothing",
                    faulty, flags.size()));
  }
}

ForceStream read_force(const AcquisitionDescription& d, AcquisitionReport& report) {
  const RawTable table(d.force_file);
  ForceStream stream;
  stream.t_s = table.times_s();
  report.force_samples.total = table.rows();
  if (table.has("v1_V")) {
    if (!d.calibration_file)
      throw BadData(
          fmt::format("{}: /force/calibration: is needed to turn gauge voltages into forces", d.file.string()));
    const auto calibration = read_ati_calibration(*d.calibration_file, d.serial);
    const GaugeVoltages bias = d.bias ? mean_volts(table, stream.t_s, *d.bias) : GaugeVoltages{};
    for (std::size_t i = 0; i < table.rows(); ++i) {
      GaugeVoltages v{};
      for (std::size_t k = 0; k < 6; ++k) v[k] = table.column(fmt::format("v{}_V", k + 1))[i];
      const auto sample = apply_calibration(calibration, v, bias);
      report.force_samples.saturated += (sample.flags & sample_saturated) != 0;
      report.force_samples.out_of_range += (sample.flags & sample_out_of_range) != 0;
      report.force_samples.not_finite += (sample.flags & sample_not_finite) != 0;
      stream.wrench.push_back(sample.wrench);
    }
  } else {
    const auto f = table.vectors("f", force_units, false), torque = table.vectors("t", torque_units, false);
    for (std::size_t i = 0; i < f.size(); ++i) stream.wrench.push_back({f[i], torque[i]});
    report.force_samples.not_finite =
        static_cast<std::size_t>(std::ranges::count_if(stream.wrench, [](const Wrench& w) { return !w.finite(); }));
    if (table.has("flags")) count_flags(table.column("flags"), table.source(), report);
  }
  if (report.force_samples.not_finite > 0)
    throw BadData(fmt::format("{}: {} of {} samples are not finite; take those lines out, or record again",
                              d.force_file.string(), report.force_samples.not_finite, table.rows()));
  if (report.force_samples.saturated > 0) {
    report.notes.push_back(fmt::format("{} of {} force samples have a saturated gauge: forces there are too small",
                                       report.force_samples.saturated, table.rows()));
  }
  if (report.force_samples.out_of_range > 0) {
    report.notes.push_back(fmt::format("{} of {} force samples lie beyond the sensor's calibrated range",
                                       report.force_samples.out_of_range, table.rows()));
  }
  return stream;
}

MotionStream read_motion(const AcquisitionDescription& d, AcquisitionReport& report) {
  const RawTable table(d.motion_file);
  const auto t = table.times_s();
  const auto p = table.vectors("", length_units, false);
  const auto q = table.rotations();
  MotionStream stream;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (table.has("tracked") && table.column("tracked")[i] == 0.0) {
      ++report.samples_without_tracking;
      continue;
    }
    if (!stream.t_s.empty() && t[i] - stream.t_s.back() > d.largest_gap_s)
      stream.gaps.emplace_back(stream.t_s.back(), t[i]);
    stream.t_s.push_back(t[i]);
    stream.tip_T_m.push_back(p[i] + q[i] * d.tip_P_m);
    stream.q_TS.push_back((q[i] * d.q_PS).normalized());
  }
  if (stream.t_s.size() < 2)
    throw BadData(
        fmt::format("{}: the tracker saw the probe in {} of {} samples, and 2 are needed: is the body in the file the "
                    "probe's, and were its markers in view?",
                    d.motion_file.string(), stream.t_s.size(), t.size()));
  if (!stream.gaps.empty() && !d.keep_around_gaps) {
    throw BadData(
        fmt::format("{}: the tracker lost the probe {} times for longer than {} s, first from {:.3f} to {:.3f} s; set "
                    "/motion/keep_around_gaps to leave that time out, or record again",
                    d.motion_file.string(), stream.gaps.size(), d.largest_gap_s, stream.gaps.front().first,
                    stream.gaps.front().second));
  }
  if (!stream.gaps.empty())
    report.notes.push_back(fmt::format("{} gaps in the tracking were left out", stream.gaps.size()));
  return stream;
}

// Within the motion's time and away from its gaps.
bool has_motion(const MotionStream& motion, double t_motion_s) {
  if (t_motion_s < motion.t_s.front() || t_motion_s > motion.t_s.back()) return false;
  return std::none_of(motion.gaps.begin(), motion.gaps.end(),
                      [&](const auto& gap) { return t_motion_s > gap.first && t_motion_s < gap.second; });
}

MarkerRegistration read_markers(const AcquisitionDescription& d) {
  const RawTable table(*d.markers_file);
  auto result = register_markers(table.vectors("", length_units, false), table.vectors("m", length_units, false),
                                 d.markers_file->string());
  if (result.residual_rms_m > d.largest_marker_residual_m) {
    const auto worst = std::max_element(result.residual_m.begin(), result.residual_m.end());
    throw BadData(
        fmt::format("{}: the markers fit with {:.3g} mm RMS, more than {:.3g} mm; marker {} is worst with {:.3g} mm: "
                    "is the order the "
                    "same in both frames?",
                    d.markers_file->string(), 1e3 * result.residual_rms_m, 1e3 * d.largest_marker_residual_m,
                    std::distance(result.residual_m.begin(), worst) + 1, 1e3 * *worst));
  }
  return result;
}

// Force on the tip in the tracker's frame at every force sample that has motion; times on the motion's clock.
struct TipForce {
  std::vector<double> t_s;
  std::vector<Vec3> f_T_N;
  std::vector<Vec3> torque_T_Nm;
};

TipForce force_at_tip(const AcquisitionDescription& d, const ForceStream& force, const MotionStream& motion,
                      const ToolLoad& tool, const ClockAlignment& clocks) {
  TipForce result;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < force.t_s.size(); ++i) {
    const double t = clocks.to_motion_clock(force.t_s[i]);
    if (has_motion(motion, t)) result.t_s.push_back(t), index.push_back(i);
  }
  if (index.size() < 2) {
    throw BadData(fmt::format(
        "{}: force ({:.3f} to {:.3f} s of the motion's clock) and motion ({:.3f} to {:.3f} s) do not overlap: are both "
        "files of the same run, and is /clocks/offset_s, if given, the force's time less the motion's?",
        d.file.string(), clocks.to_motion_clock(force.t_s.front()), clocks.to_motion_clock(force.t_s.back()),
        motion.t_s.front(), motion.t_s.back()));
  }
  const auto q = slerp_at(motion.t_s, motion.q_TS, result.t_s, d.motion_file.string());
  for (std::size_t i = 0; i < index.size(); ++i) {
    const Wrench w =
        rotated(q[i], contact_wrench_at_tip(force.wrench[index[i]], tool, q[i], d.gravity_T_m_per_s2, d.tip_S_m));
    result.f_T_N.push_back(w.f_N);
    result.torque_T_Nm.push_back(w.torque_Nm);
  }
  return result;
}

// The bias interval should be free air: there the force moves by no more than a contact is, and than the tool's weight
// as the tool turns. Means over short blocks, so that noise counts little. Returns what to say, or nothing.
std::optional<std::string> contact_in_bias(const AcquisitionDescription& d, const ForceStream& force, double weight_N) {
  constexpr double block_s = 0.05;
  constexpr std::size_t fewest = 3;  // samples of a block
  if (!d.bias) return std::nullopt;
  std::vector<Vec3> means;
  std::vector<double> at;
  std::size_t i = 0;
  while (i < force.t_s.size() && force.t_s[i] < d.bias->from_s) ++i;
  while (i < force.t_s.size() && force.t_s[i] <= d.bias->to_s) {
    const double begin_s = force.t_s[i];
    Vec3 sum = Vec3::Zero();
    std::size_t n = 0;
    for (; i < force.t_s.size() && force.t_s[i] <= d.bias->to_s && force.t_s[i] < begin_s + block_s; ++i, ++n)
      sum += force.wrench[i].f_N;
    if (n >= fewest) means.emplace_back(sum / static_cast<double>(n)), at.push_back(begin_s);
  }
  if (means.size() < fewest) return std::nullopt;
  Vec3 middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(means.size());
    for (const Vec3& f : means) values.push_back(f[axis]);
    middle[axis] = stats::upper_median(std::move(values));
  }
  const double most_N = d.contact_force_N + 2.0 * weight_N;  // a tool that turns over
  std::size_t worst = 0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    if ((means[k] - middle).norm() > (means[worst] - middle).norm()) worst = k;
  }
  const double largest_N = (means[worst] - middle).norm();
  if (!(largest_N > most_N)) return std::nullopt;
  return fmt::format(
      "contact: something is touched in the bias interval of {} to {} s: at {:.2f} s the force is {:.3g} N off its "
      "middle there (free air: up to {:.3g} N); choose an interval in free air for /force/bias_from_s",
      d.bias->from_s, d.bias->to_s, at[worst], largest_N, most_N);
}

ClockAlignment align_streams(const AcquisitionDescription& d, const ForceStream& force, const MotionStream& motion,
                             const ToolLoad& tool, const Quat& q_WT) {
  ClockStreams streams;
  streams.t_force_s = force.t_s;
  streams.force_S_N.reserve(force.wrench.size());
  for (const Wrench& w : force.wrench) streams.force_S_N.push_back(w.f_N);
  streams.t_motion_s = motion.t_s;
  streams.tip_T_m = motion.tip_T_m;
  streams.q_TS = motion.q_TS;
  streams.tool = tool;
  streams.tip_S_m = d.tip_S_m;
  streams.gravity_T_m_per_s2 = d.gravity_T_m_per_s2;
  streams.normal_T = q_WT.conjugate() * d.tap_normal_W;
  return align_clocks(streams, d.taps, d.file.string());
}

// The load that the sensor carries: identified from poses at rest, as described, or none.
ToolLoad find_tool(const AcquisitionDescription& d, AcquisitionReport& report) {
  if (d.tool_file) {
    const auto poses = read_static_poses(*d.tool_file, false);
    report.tool = identify_tool(poses, d.gravity_T_m_per_s2, d.tool_file->string());
    const FrameCheck frames = check_frames(poses, {}, *report.tool, d.gravity_T_m_per_s2, d.tool_file->string());
    if (frames.bad_fit) report.notes.push_back(frames.message(*report.tool, d.tool_file->string()));
    return report.tool->load;
  }
  if (d.tool) return *d.tool;
  report.notes.emplace_back("no tool was described: its weight counts as contact force");
  return {};
}

// Tracker to object.
RigidTransform find_object(const AcquisitionDescription& d, AcquisitionReport& report) {
  if (!d.markers_file) {
    report.notes.emplace_back("no markers: positions are in the tracker's frame");
    return {};
  }
  report.markers = read_markers(d);
  if (report.markers->markers == 3)
    report.notes.emplace_back("three markers fit almost anything: their residual says little about the registration");
  return report.markers->tracker_to_object;
}

ClockAlignment find_clocks(const AcquisitionDescription& d, const ForceStream& force, const MotionStream& motion,
                           const ToolLoad& tool, const Quat& q_WT, AcquisitionReport& report) {
  if (!d.align_taps) {
    ClockAlignment clocks;
    clocks.offset_s = d.known_offset_s;
    return clocks;
  }
  report.clocks = align_streams(d, force, motion, tool, q_WT);
  if (!report.clocks->skew_fitted)
    report.notes.emplace_back("the taps do not tell the clocks' skew; tap before and after scanning");
  return *report.clocks;
}

// Both streams at the times of the motion's samples, in the tracker's frame T.
struct Merged {
  std::vector<double> t_s;
  std::vector<std::size_t> sample;  // of the motion
  std::vector<Vec3> p_T_m;
  std::vector<Vec3> f_T_N;
  std::vector<Vec3> torque_T_Nm;
};

// The motion's samples that have force around them, force (and motion, if asked for) smoothed to the bands described.
Merged merge_streams(const AcquisitionDescription& d, const TipForce& tip, const MotionStream& motion,
                     AcquisitionReport& report) {
  Merged merged;
  const double interval = sample_interval_s(tip.t_s);
  for (std::size_t i = 0; i < motion.t_s.size(); ++i) {
    if (motion.t_s[i] >= tip.t_s.front() - interval && motion.t_s[i] <= tip.t_s.back() + interval)
      merged.t_s.push_back(motion.t_s[i]), merged.sample.push_back(i);
  }
  const auto smooth_force = smooth_at(tip.t_s, tip.f_T_N, merged.t_s, d.force_cutoff_Hz, d.force_file.string());
  merged.f_T_N = smooth_force.values;
  merged.torque_T_Nm = smooth_at(tip.t_s, tip.torque_T_Nm, merged.t_s, d.force_cutoff_Hz, d.force_file.string()).values;
  report.force_bandwidth_Hz = smooth_force.bandwidth_Hz;
  report.noise_gain = smooth_force.noise_gain;
  report.motion_bandwidth_Hz = 0.5 / sample_interval_s(motion.t_s);
  if (report.force_bandwidth_Hz > report.motion_bandwidth_Hz) {
    report.notes.push_back(
        fmt::format("the force keeps up to {:.3g} Hz, more than the motion's {:.3g} Hz samples can carry: it aliases",
                    report.force_bandwidth_Hz, 2 * report.motion_bandwidth_Hz));
  }
  if (d.motion_cutoff_Hz > 0.0) {
    const auto smooth = smooth_at(motion.t_s, motion.tip_T_m, merged.t_s, d.motion_cutoff_Hz, d.motion_file.string());
    merged.p_T_m = smooth.values;
    report.motion_bandwidth_Hz = smooth.bandwidth_Hz;
  } else {
    merged.p_T_m.reserve(merged.sample.size());
    for (const std::size_t i : merged.sample) merged.p_T_m.push_back(motion.tip_T_m[i]);
  }
  return merged;
}

// The object's place, corrected so that the tip's ball touches the mesh where it presses.
RigidTransform corrected_by_contacts(const AcquisitionDescription& d, const Merged& merged,
                                     const RigidTransform& object, AcquisitionReport& report) {
  const auto surface = make_embree_surface(load_mesh(*d.mesh_file, length_unit_factor(d.mesh_unit)));
  std::vector<Vec3> centers;
  for (std::size_t i = 0; i < merged.t_s.size(); ++i) {
    if (merged.f_T_N[i].norm() >= d.contact_force_N) centers.push_back(object.point(merged.p_T_m[i]));
  }
  report.contacts = register_contacts(*surface, centers, d.tip_radius_m, {}, d.file.string());
  if (report.contacts->determined_directions < 6) {
    report.notes.push_back(
        fmt::format("the contacts determine {} of 6 directions; the others are as the markers left them",
                    report.contacts->determined_directions));
  }
  return report.contacts->correction * object;
}

}  // namespace

std::vector<StaticPose> read_static_poses(const std::filesystem::path& path, bool bare_is_si) {
  const RawTable table(path);
  const auto f = table.vectors("f", force_units, bare_is_si), torque = table.vectors("t", torque_units, bare_is_si);
  const auto q = table.rotations();
  std::vector<StaticPose> poses;
  poses.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) poses.push_back({q[i], {f[i], torque[i]}});
  return poses;
}

Acquired acquire(const AcquisitionDescription& d) {
  Acquired result;
  AcquisitionReport& report = result.report;
  for (const auto& file : {std::optional(d.file), std::optional(d.force_file), d.calibration_file,
                           std::optional(d.motion_file), d.tool_file, d.markers_file, d.mesh_file}) {
    if (file) report.inputs.emplace_back(file->filename().string(), sha256_file(*file));
  }
  const ForceStream force = read_force(d, report);
  const MotionStream motion = read_motion(d, report);
  const ToolLoad tool = find_tool(d, report);
  if (const auto contact = contact_in_bias(d, force, tool.mass_kg * d.gravity_T_m_per_s2.norm())) {
    report.notes.push_back(*contact);
    report.contact_in_free_air = true;
  }
  RigidTransform object = find_object(d, report);
  const ClockAlignment clocks = find_clocks(d, force, motion, tool, object.q, report);

  const TipForce tip = force_at_tip(d, force, motion, tool, clocks);
  std::vector<Wrench> free_air;
  for (std::size_t i = 0; i < tip.t_s.size(); ++i) {
    if (tip.f_T_N[i].norm() < 0.5 * d.contact_force_N) free_air.push_back({tip.f_T_N[i], tip.torque_T_Nm[i]});
  }
  report.free_air = residual_of(free_air);

  const Merged merged = merge_streams(d, tip, motion, report);
  if (d.mesh_file) object = corrected_by_contacts(d, merged, object, report);

  Recording& recording = result.recording;
  recording.source = d.file.string();
  for (std::size_t i = 0; i < merged.t_s.size(); ++i) {
    recording.motion.t_s.push_back(merged.t_s[i]);
    recording.motion.p_W_m.push_back(object.point(merged.p_T_m[i]));
    recording.motion.q_WS.push_back((object.q * motion.q_TS[merged.sample[i]]).normalized());
    recording.f_W_N.push_back(object.q * merged.f_T_N[i]);
    recording.torque_W_Nm.push_back(object.q * merged.torque_T_Nm[i]);
  }
  return result;
}

}  // namespace touchstone::acquisition
