#include "acquire.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <span>

#include "clock_parts.h"
#include "frame_check.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/units.h"
#include "harness/recording/raw_table.h"
#include "harness/stats/quantile.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "raw_streams.h"
#include "session_check.h"

namespace touchstone::acquisition {
using recording::RawTable;
namespace {

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
    const auto poses = recording::read_static_poses(*d.tool_file, false);
    report.tool = recording::identify_tool(poses, d.gravity_T_m_per_s2, d.tool_file->string());
    report.gains = identify_gains(poses, d.gravity_T_m_per_s2);
    const FrameCheck frames = check_frames(poses, {}, *report.tool, d.gravity_T_m_per_s2, d.tool_file->string());
    if (frames.bad_fit) throw BadData(frames.message(*report.tool, d.tool_file->string()));
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

// A bias that moved spoils the alignment too. Without the clocks the orientation is not known, but at rest the force
// less the bias has the tool's weight as its length. Empty where it does, at the begin and at the end of the session.
std::string bias_by_length(const AcquisitionDescription& d, const ForceStream& force, const ToolLoad& tool) {
  constexpr double level_s = 0.3;
  if (!(tool.mass_kg > 0.0)) return {};
  const double weight_N = tool.mass_kg * d.gravity_T_m_per_s2.norm();
  double worst_N = 0.0;
  for (const double from_s : {force.t_s.front(), force.t_s.back() - level_s}) {
    Vec3 level = Vec3::Zero();
    double n = 0.0;
    for (std::size_t i = 0; i < force.t_s.size(); ++i) {
      if (force.t_s[i] >= from_s && force.t_s[i] <= from_s + level_s) level += force.wrench[i].f_N, n += 1.0;
    }
    worst_N = std::max(worst_N, std::abs((level / n - tool.bias.f_N).norm() - weight_N));
  }
  if (!(worst_N > 0.25 * d.contact_force_N)) return {};
  return fmt::format(
      ". The force's bias moved by {:.2g} N or more against the tool's: that is how far the force is off the tool's "
      "weight at the begin or the end of the session; measure the static poses again, or record again",
      worst_N);
}

ClockAlignment find_clocks(const AcquisitionDescription& d, const ForceStream& force, const MotionStream& motion,
                           const ToolLoad& tool, const Quat& q_WT, AcquisitionReport& report) {
  if (!d.align_taps) {
    ClockAlignment clocks;
    clocks.offset_s = d.known_offset_s;
    return clocks;
  }
  try {
    report.clocks = align_streams(d, force, motion, tool, q_WT);
  } catch (const BadData& error) {
    throw BadData(error.what() + bias_by_length(d, force, tool));
  }
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

// The sensor reads bias + weight of the tool where nothing touches: the mean over the bias interval less the weight is
// the bias of this run, whatever it was when the static poses were taken.
void take_bias(const AcquisitionDescription& d, const ForceStream& force, const MotionStream& motion,
               const ClockAlignment& clocks, ToolLoad& tool) {
  if (!d.bias) return;
  std::vector<double> at;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < force.t_s.size(); ++i) {
    if (force.t_s[i] < d.bias->from_s || force.t_s[i] > d.bias->to_s) continue;
    const double t = clocks.to_motion_clock(force.t_s[i]);
    if (has_motion(motion, t)) at.push_back(t), index.push_back(i);
  }
  if (index.size() < fewest_of_bias) {
    throw BadData(fmt::format(
        "{}: in the bias interval {} to {} s {} samples of the force have a pose of the probe, and {} are needed: the "
        "force's clock runs from {:.3f} to {:.3f} s, and the tracker must see the probe",
        d.file.string(), d.bias->from_s, d.bias->to_s, index.size(), fewest_of_bias, force.t_s.front(),
        force.t_s.back()));
  }
  const auto q = slerp_at(motion.t_s, motion.q_TS, at, d.motion_file.string());
  ToolLoad weight = tool;
  weight.bias = {};
  Wrench mean;
  for (std::size_t i = 0; i < index.size(); ++i) {
    const Wrench own = tool_wrench(weight, q[i], d.gravity_T_m_per_s2);
    mean.f_N += (force.wrench[index[i]].f_N - own.f_N) / static_cast<double>(index.size());
    mean.torque_Nm += (force.wrench[index[i]].torque_Nm - own.torque_Nm) / static_cast<double>(index.size());
  }
  tool.bias = mean;
}

// A ball this far from the mesh does not touch it, wherever within their limit the markers leave the object.
double clear_gap_m(const AcquisitionDescription& d) { return 2.5 * d.largest_marker_residual_m; }

// The samples at a session's begin that stay near the level they start at: free air, where one taps before scanning.
// A hand that moves the tool makes up to a quarter of its weight (free_air.h).
std::size_t free_air_from(std::span<const Vec3> force_N, std::span<const double> t_s, double most_N) {
  constexpr double level_s = 0.3, smoothed_s = 0.1;
  Vec3 level = Vec3::Zero();
  std::size_t n = 0;
  while (n < t_s.size() && std::abs(t_s[n] - t_s[0]) < level_s) level += force_N[n++];
  level /= static_cast<double>(n);
  n = 0;
  while (n < t_s.size() && (force_N[n] - level).norm() < most_N) ++n;
  if (n == t_s.size()) return n;
  const double contact_s = t_s[n];
  while (n > 0 && std::abs(t_s[n - 1] - contact_s) < smoothed_s) --n;  // what smoothing brings of the contact
  return n;
}

// The merged samples at which nothing can be touched: farther from the mesh than markers and scan may be wrong, and not
// near a tap (one may tap a table); without a mesh, but with taps before and after, the begin and the end.
std::vector<bool> free_air_of(const AcquisitionDescription& d, const Merged& merged, const std::vector<double>& gap_m,
                              const TipForce& tip, const Vec3& normal_T, double weight_N) {
  constexpr double beside_tap_s = 0.1;
  std::vector<bool> free(merged.t_s.size(), false);
  if (gap_m.empty()) {
    if (!d.align_taps) return free;
    const double most_N = d.contact_force_N + 0.25 * weight_N;
    const std::vector<double> t_back(merged.t_s.rbegin(), merged.t_s.rend());
    const std::vector<Vec3> f_back(merged.f_T_N.rbegin(), merged.f_T_N.rend());
    std::fill_n(free.begin(), free_air_from(merged.f_T_N, merged.t_s, most_N), true);
    std::fill_n(free.rbegin(), free_air_from(f_back, t_back, most_N), true);
    return free;
  }
  std::vector<double> push;
  push.reserve(tip.f_T_N.size());
  for (const Vec3& f : tip.f_T_N) push.push_back(normal_T.dot(f));
  const auto taps = find_force_taps(tip.t_s, push, d.taps);
  for (std::size_t i = 0; i < free.size(); ++i) {
    const double t = merged.t_s[i];
    free[i] = gap_m[i] > clear_gap_m(d) && std::ranges::none_of(taps, [&](const ForceTap& tap) {
                return t > tap.onset_s - beside_tap_s && t < tap.release_s + beside_tap_s;
              });
  }
  return free;
}

// Throws all sentences at once: each is a reason why the recording would be wrong.
void refuse(const AcquisitionDescription& d, const std::vector<std::string>& faults) {
  if (faults.empty()) return;
  throw BadData(fmt::format("{}: {}", d.file.string(), fmt::join(faults, "; ")));
}

void check_air(const AcquisitionDescription& d, const Merged& merged, const MotionStream& motion,
               std::vector<bool> free_air, const ToolLoad& tool, AcquisitionReport& report) {
  SessionSamples samples{merged.t_s, merged.p_T_m, merged.f_T_N, {}, std::move(free_air)};
  for (const std::size_t i : merged.sample) samples.q_TS.push_back(motion.q_TS[i]);
  const FreeAirCheck check = check_free_air(samples, tool, d.gravity_T_m_per_s2, d.contact_force_N);
  if (check.blocks == 0)
    report.notes.emplace_back(
        "cannot tell whether the force's bias held: there are fewer than two stretches of half a second of free air "
        "(far from the mesh, or before the first and after the last tap)");
  if (!check.event.empty()) report.notes.push_back(check.event);
  report.contact_in_free_air = !check.event.empty();
  refuse(d, check.faults);
}

void check_gains(const AcquisitionDescription& d, const Merged& merged, const MotionStream& motion,
                 AcquisitionReport& report) {
  std::vector<Vec3> contact_S_N;
  for (std::size_t i = 0; i < merged.t_s.size(); ++i) {
    if (merged.f_T_N[i].norm() >= d.contact_force_N)
      contact_S_N.push_back(motion.q_TS[merged.sample[i]].conjugate() * merged.f_T_N[i]);
  }
  report.gain_error = gain_error(report.gains, contact_S_N, d.contact_force_N, d.weighed_kg);
  if (!report.gain_error->fault.empty()) refuse(d, {report.gain_error->fault});
  if (!report.gain_error->doubt.empty()) report.notes.push_back(report.gain_error->doubt);
}

ContactSamples contacts_at(const AcquisitionDescription& d, const Merged& merged, const MotionStream& motion,
                           const std::vector<std::size_t>& index, const RigidTransform& object) {
  // The outermost frame within half of the span, and the next one at least.
  const auto reach = [&](std::size_t i, std::size_t last, auto next) {
    std::size_t k = i;
    while (k != last && (k == i || std::abs(merged.t_s[next(k)] - merged.t_s[i]) <= 0.5 * speed_span_s)) k = next(k);
    return k;
  };
  ContactSamples contacts;
  for (const std::size_t i : index) {
    const std::size_t before = reach(i, 0, [](std::size_t k) { return k - 1; }),
                      after = reach(i, merged.t_s.size() - 1, [](std::size_t k) { return k + 1; });
    contacts.t_s.push_back(merged.t_s[i]);
    contacts.center_W_m.push_back(object.point(merged.p_T_m[i]));
    contacts.force_W_N.push_back(object.q * merged.f_T_N[i]);
    contacts.torque_W_Nm.push_back(object.q * merged.torque_T_Nm[i]);
    contacts.velocity_W_m_per_s.push_back(object.q * (merged.p_T_m[after] - merged.p_T_m[before]) /
                                          (merged.t_s[after] - merged.t_s[before]));
    contacts.q_WS.push_back(object.q * motion.q_TS[merged.sample[i]]);
    contacts.q_WP.push_back(contacts.q_WS.back() * d.q_PS.conjugate());
  }
  return contacts;
}

// The object's place, corrected so that the tip's ball touches the mesh where it presses, less what the surface gives
// in under the force: twice, since how far it gives in follows from the place and the place from that.
RigidTransform corrected_by_contacts(const AcquisitionDescription& d, const surface::Surface& surface,
                                     const Merged& merged, const MotionStream& motion, const std::vector<double>& gap_m,
                                     const RigidTransform& object, AcquisitionReport& report) {
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < merged.t_s.size(); ++i) {
    if (merged.f_T_N[i].norm() >= d.contact_force_N && gap_m[i] < clear_gap_m(d)) index.push_back(i);
  }
  const ContactSamples by_markers = contacts_at(d, merged, motion, index, object);
  RigidTransform corrected = object;
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Vec3> centers = by_markers.center_W_m;
    if (pass > 0) {
      const double give =
          contact_compliance_m_per_N(surface, contacts_at(d, merged, motion, index, corrected), d.tip_radius_m);
      for (std::size_t i = 0; i < centers.size(); ++i) centers[i] += give * by_markers.force_W_N[i];
    }
    report.contacts = register_contacts(surface, centers, d.tip_radius_m, {}, d.file.string());
    corrected = report.contacts->correction * object;
  }
  if (report.contacts->determined_directions < 6) {
    report.notes.push_back(
        fmt::format("the contacts determine {} of 6 directions; the others are as the markers left them",
                    report.contacts->determined_directions));
  }
  const ContactSamples by_contacts = contacts_at(d, merged, motion, index, corrected);
  const RigidTransform correction =
      weighed_correction(surface, by_contacts, d.tip_radius_m, *report.contacts, *report.markers);
  report.object_move = object_move(surface, contacts_at(d, merged, motion, index, correction * object), d.tip_radius_m,
                                   motion.noise_m, correction, *report.markers);
  const ContactCheck check = check_contacts(surface, by_contacts, d.tip_radius_m, motion.noise_m, d.contact_force_N,
                                            *report.contacts, *report.markers, *report.object_move);
  refuse(d, check.faults);
  std::ranges::copy(check.doubts, std::back_inserter(report.notes));
  if (auto doubt = report.object_move->doubt(); !doubt.empty()) report.notes.push_back(std::move(doubt));
  return correction * object;
}

}  // namespace

Acquired acquire(const AcquisitionDescription& d) {
  Acquired result;
  AcquisitionReport& report = result.report;
  for (const auto& file : {std::optional(d.file), std::optional(d.force_file), d.calibration_file,
                           std::optional(d.motion_file), d.tool_file, d.markers_file, d.mesh_file}) {
    if (file) report.inputs.emplace_back(file->filename().string(), sha256_file(*file));
  }
  const ForceStream force = read_force(d, report);
  const MotionStream motion = read_motion(d, report);
  ToolLoad tool = find_tool(d, report);
  if (const auto contact = contact_in_bias(d, force, tool.mass_kg * d.gravity_T_m_per_s2.norm()))
    throw BadData(fmt::format("{}: {}", d.file.string(), *contact));
  RigidTransform object = find_object(d, report);
  const ClockAlignment clocks = find_clocks(d, force, motion, tool, object.q, report);
  take_bias(d, force, motion, clocks, tool);

  const TipForce tip = force_at_tip(d, force, motion, tool, clocks);
  std::vector<Wrench> free_air;
  for (std::size_t i = 0; i < tip.t_s.size(); ++i) {
    if (tip.f_T_N[i].norm() < 0.5 * d.contact_force_N) free_air.push_back({tip.f_T_N[i], tip.torque_T_Nm[i]});
  }
  report.free_air = recording::residual_of(free_air);

  const Merged merged = merge_streams(d, tip, motion, report);
  std::shared_ptr<const surface::Surface> surface;
  std::vector<double> gap_m;
  if (d.mesh_file) {
    surface = make_embree_surface(surface::load_mesh(*d.mesh_file, length_unit_factor(d.mesh_unit)));
    for (const Vec3& p : merged.p_T_m)
      gap_m.push_back(surface->closest(object.point(p)).signed_distance_m - d.tip_radius_m);
  }
  // Without a tool its weight is in the force, as the note says: there is nothing to hold free air against.
  if (d.tool_file || d.tool) {
    // Wrong gains show in free air too, as a bias.
    check_gains(d, merged, motion, report);
    const double weight_N = tool.mass_kg * d.gravity_T_m_per_s2.norm();
    check_air(d, merged, motion, free_air_of(d, merged, gap_m, tip, object.q.conjugate() * d.tap_normal_W, weight_N),
              tool, report);
  }
  if (!surface)
    report.notes.emplace_back(
        "without a mesh nothing shows whether the object stayed at rest, and the tip is where it is described");
  if (surface) object = corrected_by_contacts(d, *surface, merged, motion, gap_m, object, report);

  recording::Recording& recording = result.recording;
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
