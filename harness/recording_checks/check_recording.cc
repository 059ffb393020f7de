#include "harness/recording_checks/check_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/base/error.h"
#include "harness/recording/force_sign.h"
#include "harness/recording_checks/block_order.h"
#include "harness/recording_checks/column_faults.h"
#include "harness/recording_checks/force_frame.h"
#include "harness/recording_checks/force_noise.h"
#include "harness/recording_checks/load_lag.h"
#include "harness/recording_checks/placement.h"
#include "harness/rendering/nearness.h"
#include "harness/stats/quantile.h"

namespace touchstone::recording_checks {
using recording::Recording;
using recording::SignVerdict;

namespace {

// The recording against the surface, sample by sample (evenly thinned where it is long).
struct Contact {
  std::vector<double> t_s, depth_m, load_N;
  std::vector<Vec3> n_W, f_W_N;
  std::vector<Quat> q_WS;
};

constexpr std::size_t most_samples = 20000;

Contact against(const Recording& r, const RecordingContext& context) {
  Contact c;
  const std::size_t stride = r.size() / most_samples + 1;
  for (std::size_t i = 0; i < r.size(); i += stride) {
    const surface::SurfacePoint foot = context.surface->closest(r.motion.p_W_m[i]);
    c.t_s.push_back(r.motion.t_s[i]);
    c.n_W.push_back(foot.n_W);
    c.f_W_N.push_back(r.f_W_N[i]);
    c.depth_m.push_back(std::max(0.0, context.tip_radius_m - foot.signed_distance_m));
    c.load_N.push_back(r.f_W_N[i].dot(foot.n_W));
    if (!r.motion.q_WS.empty()) c.q_WS.push_back(r.motion.q_WS[i]);
  }
  return c;
}

// The samples that push: in free air the direction of the force is that of its noise.
Contact touching_part(const Contact& all, double touching_N) {
  Contact part;
  for (std::size_t i = 0; i < all.f_W_N.size(); ++i) {
    if (!(all.f_W_N[i].norm() > touching_N)) continue;
    part.n_W.push_back(all.n_W[i]);
    part.f_W_N.push_back(all.f_W_N[i]);
    if (!all.q_WS.empty()) part.q_WS.push_back(all.q_WS[i]);
  }
  return part;
}

std::vector<double> negated(std::vector<double> values) {
  for (double& v : values) v = -v;
  return values;
}

// What the object adds to the load grows with the depth; the weight of a tool, or a bias, points into the object or out
// of it all the time. So the change of the load decides, and its mean only where the load does not change. A load that
// falls with the depth may also come late by half of a period: then the clock is named.
std::optional<RecordingFinding> reversed_force(const Contact& c, const RecordingContext& context, double touching_N) {
  const recording::ForceSign change = recording::check_load_change(c.depth_m, c.load_N);
  if (change.verdict == SignVerdict::outward) return std::nullopt;
  const double follows = correlation(c.depth_m, c.load_N);
  const bool nearly_all = 1.0 - follows * follows < context.most_left_with_repair;
  // A load that rises with the depth is the object's, also where too few blocks touch to decide by their change.
  if (nearly_all && follows > 0.0) return std::nullopt;
  const bool falls = change.verdict == SignVerdict::reversed && nearly_all &&
                     !find_load_lag(c.t_s, c.load_N, c.depth_m, context.most_left_with_repair);
  const Contact touching = touching_part(c, touching_N);
  const recording::ForceSign mean = recording::check_force_sign(touching.n_W, touching.f_W_N);
  std::string message;
  if (mean.verdict == SignVerdict::reversed) {
    message = mean.explain();
  } else if (falls) {
    message = fmt::format(
        "the deeper the tip, the less the force pushes outward (statistic {:.3f}, p = {:.2g} over {} blocks of {} "
        "samples): it looks like the force BY the probe, with a weight or a bias; Touchstone takes forces ON the probe "
        "BY the object",
        change.statistic, change.p_value, change.blocks, change.samples);
  } else {
    return std::nullopt;
  }
  // A constant load follows nothing, reversed or not.
  if (std::abs(follows) > 0.1) {
    message += fmt::format("; with the force reversed the load follows the position (correlation {:.3f} -> {:.3f})",
                           follows, correlation(c.depth_m, negated(c.load_N)));
  }
  return RecordingFinding{FaultWeight::fault, RecordingFault::reversed_force, std::move(message),
                          context.force_flipped ? "leave --flip-force out, or turn the mesh inside out"
                                                : "if the file has the force BY the probe, give --flip-force"};
}

std::optional<RecordingFinding> far_away(const Recording& r, const RecordingContext& context, double touching_N) {
  std::vector<Vec3> touching;
  std::vector<double> loads_N;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (!(r.f_W_N[i].norm() > touching_N)) continue;
    touching.push_back(r.motion.p_W_m[i]), loads_N.push_back(r.f_W_N[i].norm());
  }
  const auto message = rendering::far_from_surface(*context.surface, touching.empty() ? r.motion.p_W_m : touching,
                                                   loads_N, context.tip_radius_m, r.source, context.mesh_unit);
  if (!message) return std::nullopt;
  return RecordingFinding{FaultWeight::fault, RecordingFault::mesh_unit_or_place, *message, ""};
}

std::optional<RecordingFinding> wrong_frame(const Contact& c, const RecordingContext& context, double touching_N) {
  const Contact touching = touching_part(c, touching_N);
  const auto frame = find_force_frame(touching.n_W, touching.f_W_N, touching.q_WS, context.most_left_with_repair);
  if (!frame) return std::nullopt;
  return RecordingFinding{
      FaultWeight::fault, RecordingFault::force_frame,
      fmt::format("{}: read so, forces lie along the outward normal (alignment {:.3f} -> {:.3f})", frame->meaning,
                  frame->alignment, frame->repaired),
      frame->map_key.empty() ? "correct these columns of the file (fx_N, fy_N, fz_N)"
                             : fmt::format("read the file with `touchstone import` and {} in the map", frame->map_key)};
}

std::optional<RecordingFinding> wrong_order(const Contact& c, const RecordingContext& context) {
  const auto order = find_wrong_order(c.t_s, c.load_N, c.depth_m, context.most_left_with_repair);
  if (!order) return std::nullopt;
  return RecordingFinding{
      FaultWeight::remark, RecordingFault::order,
      fmt::format("the force does not follow the position (correlation {:.2f}), but would {} ({:.2f})",
                  order->correlation, order->remedy(), order->reordered),
      "join the pieces of the log in the order of their time"};
}

std::optional<RecordingFinding> wrong_clock(const Contact& c, const RecordingContext& context) {
  const auto lag = find_load_lag(c.t_s, c.load_N, c.depth_m, context.most_left_with_repair);
  if (!lag) return std::nullopt;
  std::string message = fmt::format(
      "the force comes {:.3g} s {} than the position: shifted by it the load follows the depth (correlation {:.3f} -> "
      "{:.3f})",
      std::abs(lag->lag_s), lag->lag_s > 0.0 ? "later" : "earlier", lag->correlation, lag->shifted);
  if (lag->drift_s != 0.0) {
    message += fmt::format("; it is {:.3g} s more in the second half: the two clocks drift", lag->drift_s);
  }
  return RecordingFinding{
      FaultWeight::remark, RecordingFault::clock, std::move(message),
      fmt::format("read the file with `touchstone import` and \"shift_force_s\": {:.4g} in the map", -lag->lag_s)};
}

// The force above which a sample pushes: noise alone exceeds five of its deviations once in 60,000 samples (chi with
// three degrees of freedom). Half of what the hardest presses reach at most, since samples taken far apart show motion
// as noise.
double touching_threshold_N(const Recording& r, double contact_force_N) {
  constexpr double deviations = 5.0, hardest = 0.98, most_of_hardest = 0.5;
  std::vector<double> sizes;
  for (const Vec3& f : r.f_W_N) sizes.push_back(f.norm());
  return std::max(contact_force_N, std::min(deviations * force_noise_N(r.f_W_N),
                                            most_of_hardest * stats::lower_quantile(std::move(sizes), hardest)));
}

}  // namespace

std::string_view to_string(RecordingFault fault) {
  switch (fault) {
    case RecordingFault::reversed_force:
      return "reversed force";
    case RecordingFault::mesh_unit_or_place:
      return "mesh unit or place";
    case RecordingFault::force_frame:
      return "force frame";
    case RecordingFault::order:
      return "order";
    case RecordingFault::clock:
      return "clock";
    case RecordingFault::registration:
      return "registration";
    case RecordingFault::no_contact:
      return "no contact";
    case RecordingFault::position_unit:
      return "unit of positions";
    case RecordingFault::stuck_position:
      return "stuck position";
    case RecordingFault::stuck_force:
      return "stuck force";
    case RecordingFault::constant_position:
      return "constant position";
    case RecordingFault::constant_force:
      return "constant force";
    case RecordingFault::saturated_force:
      return "saturated force";
    case RecordingFault::repeated_samples:
      return "repeated samples";
  }
  return "";
}

std::vector<RecordingFinding> find_recording_faults(const Recording& recording, const RecordingContext& context) {
  std::vector<RecordingFinding> findings;
  const auto add = [&](std::optional<RecordingFinding> finding) {
    if (finding) findings.push_back(std::move(*finding));
    return !findings.empty();
  };
  if (context.surface != nullptr && recording.size() > 0 && recording.f_W_N.size() == recording.size()) {
    const double touching_N = touching_threshold_N(recording, context.contact_force_N);
    // Far from the surface its normals and depths mean nothing; reversed forces make every later test fail.
    if (add(far_away(recording, context, touching_N))) return findings;
    const Contact contact = against(recording, context);
    // The weight of a tool that is turned in the air would be mistaken for a force into the object below it. A lag
    // makes blocks of its own length fit in another order: it goes before their order.
    if (rendering::held_in_the_air(*context.surface, recording.motion.p_W_m, context.tip_radius_m)) {
      add(touches_nothing(recording, context));
    } else if (!add(wrong_frame(contact, context, touching_N)) && !add(reversed_force(contact, context, touching_N)) &&
               !add(wrong_clock(contact, context))) {
      add(wrong_order(contact, context));
      add(find_misplacement(recording, context, touching_N, context.noticed_share_of_load));
      add(touches_nothing(recording, context));
    }
  }
  for (const ColumnFault& fault : find_column_faults(recording)) {
    findings.push_back({FaultWeight::remark, fault.fault, fault.message, fault.repair});
  }
  std::ranges::stable_sort(findings, [](const RecordingFinding& a, const RecordingFinding& b) {
    return a.weight == FaultWeight::fault && b.weight == FaultWeight::remark;
  });
  return findings;
}

std::string finding_line(const RecordingFinding& finding) {
  return finding.repair.empty() ? finding.message : fmt::format("{}; {}", finding.message, finding.repair);
}

std::vector<std::string> refuse_faulty(const Recording& recording, const RecordingContext& context) {
  std::vector<std::string> remarks;
  for (const RecordingFinding& finding : find_recording_faults(recording, context)) {
    if (finding.weight == FaultWeight::fault) {
      const std::string line = finding_line(finding);
      // The check of places names the recording itself.
      throw BadData(line.find(recording.source) != std::string::npos ? line
                                                                     : fmt::format("{}: {}", recording.source, line));
    }
    remarks.push_back(fmt::format("{}: {}: {}", recording.source, to_string(finding.fault), finding_line(finding)));
  }
  return remarks;
}

}  // namespace touchstone::recording_checks
