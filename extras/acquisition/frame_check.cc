#include "frame_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/base/signed_order.h"
#include "harness/stats/distributions.h"

namespace touchstone::acquisition {
namespace {

// Every reading, the plainest first: of two that fit alike, the one with fewer mistakes is named.
std::vector<PoseReading> readings() {
  using enum OrientationReading;
  std::vector<PoseReading> all;
  for (const bool flip : {false, true}) {
    for (const auto orientation : {given, inverse, scalar_last}) {
      for (const auto frame : {WrenchFrame::sensor, WrenchFrame::world}) all.push_back({frame, orientation, flip});
    }
  }
  return all;
}

// Mass and misfit of F = m g_S + b by the forces alone, in one pass: with deviations from the means, m = sum f.g / sum
// g.g.
struct ForceFit {
  double mass_kg = 0.0, left_N = std::numeric_limits<double>::infinity();  // per component, root mean square
};
ForceFit fit_forces(const std::vector<Vec3>& g_S, const std::vector<Vec3>& force, const SignedOrder& order) {
  const auto n = static_cast<double>(g_S.size());
  Vec3 mean_g = Vec3::Zero(), mean_f = Vec3::Zero();
  double gg = 0.0, fg = 0.0, ff = 0.0;
  for (std::size_t i = 0; i < g_S.size(); ++i) {
    const Vec3 f = order.applied(force[i]);
    mean_g += g_S[i] / n, mean_f += f / n;
    gg += g_S[i].squaredNorm(), fg += f.dot(g_S[i]), ff += f.squaredNorm();
  }
  gg -= n * mean_g.squaredNorm(), fg -= n * mean_f.dot(mean_g), ff -= n * mean_f.squaredNorm();
  if (!(gg > 0.0)) return {};
  return {fg / gg, std::sqrt(std::max(0.0, ff - fg * fg / gg) / (3.0 * n))};
}

// The signed order of the force's axes that explains the poses where the file's does not.
void name_axes(const std::vector<StaticPose>& poses, const Vec3& gravity_W, FrameCheck& check) {
  std::vector<Vec3> g_S, force;
  for (const StaticPose& pose : poses) {
    g_S.push_back(pose.q_WS.conjugate() * gravity_W);
    force.push_back(pose.measured.f_N);
  }
  double best_N = std::numeric_limits<double>::infinity();
  for (const SignedOrder& order : signed_orders()) {
    const ForceFit fit = fit_forces(g_S, force, order);
    const bool fits =
        fit.mass_kg > 0.0 && std::sqrt(3.0) * fit.left_N <= most_weight_left * fit.mass_kg * gravity_W.norm();
    // The plainest first: of equals it stays.
    if (!fits || !(fit.left_N < 0.9 * best_N)) continue;
    best_N = fit.left_N;
    check.axes = order.meaning();
    check.axes_mass_kg = fit.mass_kg;
    check.axes_left_N = fit.left_N;
  }
}

// The signed order of the torque's axes that explains the poses where the file's does not. With deviations from the
// means T = -[g]x (m c): a system with the same matrix sum [g]x' [g]x for every order.
void name_torque_axes(const std::vector<StaticPose>& poses, const Vec3& gravity_W, FrameCheck& check) {
  // Of the 23 other pairs of orders.
  constexpr double by_chance = 1e-4 / 23.0, clearly = 2.0;
  const auto n = static_cast<double>(poses.size());
  Vec3 mean_g = Vec3::Zero(), mean_T = Vec3::Zero();
  for (const StaticPose& pose : poses) {
    mean_g += pose.q_WS.conjugate() * gravity_W / n;
    mean_T += pose.measured.torque_Nm / n;
  }
  Mat3 normal = Mat3::Zero(), products = Mat3::Zero();  // products: of the torque's and gravity's deviations
  double TT = 0.0;
  for (const StaticPose& pose : poses) {
    const Vec3 g = pose.q_WS.conjugate() * gravity_W - mean_g, torque = pose.measured.torque_Nm - mean_T;
    normal += g.squaredNorm() * Mat3::Identity() - g * g.transpose();
    products += torque * g.transpose();
    TT += torque.squaredNorm();
  }
  const auto left2_with = [&](const SignedOrder& order) {
    // sum T x g by the products of their components.
    Mat3 ordered;
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      ordered.row(k) = order.sign.at(at) * products.row(order.from.at(at));
    }
    const Vec3 moment(ordered(2, 1) - ordered(1, 2), ordered(0, 2) - ordered(2, 0), ordered(1, 0) - ordered(0, 1));
    return TT - moment.dot(normal.ldlt().solve(moment));
  };
  const double as_read2 = left2_with({}), freedom = 3.0 * n - 6.0;
  double best2 = as_read2 / (clearly * clearly);
  if (!(freedom >= 1.0)) return;
  for (const SignedOrder& order : signed_orders()) {
    const double left2 = std::max(0.0, left2_with(order));
    const bool by_more_than_chance = !(left2 > 0.0) || stats::f_tail(as_read2 / left2, freedom, freedom) < by_chance;
    // The plainest first: of equals it stays.
    if (!(left2 < 0.8 * best2) || !by_more_than_chance) continue;
    best2 = left2;
    check.torque_axes = order.meaning('t');
    check.torque_left_Nm = std::sqrt(left2 / (3.0 * n));
  }
}

// Gains that differ from axis to axis, if they leave less than one mass for all by more than chance.
void name_gains(const std::vector<StaticPose>& poses, const Vec3& gravity_W, const ToolIdentification& as_read,
                FrameCheck& check) {
  constexpr double by_chance = 1e-4;
  const ForceGains gains = identify_gains(poses, gravity_W);
  // Each axis measures itself before all others.
  const Vec3 own = gains.mass_kg.diagonal(), others = gains.mass_kg.cwiseAbs().rowwise().sum() - own;
  if (!gains.determined || !((own - others).minCoeff() > 0.0)) return;
  const double rows = 3.0 * static_cast<double>(poses.size()), left_before = rows - 4.0, left = rows - 12.0;
  const double before2 = rows / left_before * std::pow(as_read.fit.force_component_N, 2);
  if (gains.sigma_N > 0.0 && !(stats::f_tail(before2 / (gains.sigma_N * gains.sigma_N), left_before, left) < by_chance))
    return;
  check.gains = gains;
}

}  // namespace

std::string PoseReading::flags() const {
  std::string text;
  const auto add = [&](std::string_view flag) { text += fmt::format("{}{}", text.empty() ? "" : " ", flag); };
  if (flip_force) add("--flip-force");
  if (orientation == OrientationReading::inverse) add("--orientation inverse");
  if (orientation == OrientationReading::scalar_last) add("--orientation scalar-last");
  if (wrench == WrenchFrame::world) add("--wrench-frame world");
  return text;
}

std::string PoseReading::meaning() const {
  std::string text;
  const auto add = [&](std::string_view words) { text += fmt::format("{}{}", text.empty() ? "" : ", ", words); };
  if (flip_force) add("the force is reversed");
  if (orientation == OrientationReading::inverse) add("the orientation is that of the world in the sensor's frame");
  if (orientation == OrientationReading::scalar_last) add("the quaternion's columns hold x, y, z, w in this order");
  if (wrench == WrenchFrame::world) add("the wrench is already in the world's frame");
  return text;
}

std::vector<StaticPose> read_as(const std::vector<StaticPose>& poses, const PoseReading& reading) {
  std::vector<StaticPose> result = poses;
  for (StaticPose& pose : result) {
    const Quat q = pose.q_WS;
    if (reading.orientation == OrientationReading::inverse) pose.q_WS = q.conjugate();
    // The columns qw, qx, qy, qz hold x, y, z, w.
    if (reading.orientation == OrientationReading::scalar_last) pose.q_WS = Quat(q.z(), q.w(), q.x(), q.y());
    const double sign = reading.flip_force ? -1.0 : 1.0;
    const Quat turn = reading.wrench == WrenchFrame::world ? pose.q_WS.conjugate() : Quat::Identity();
    pose.measured = {sign * (turn * pose.measured.f_N), sign * (turn * pose.measured.torque_Nm)};
  }
  return result;
}

double share_of_weight_left(const ToolIdentification& found, const Vec3& gravity_W_m_per_s2) {
  const double weight_N = std::abs(found.load.mass_kg) * gravity_W_m_per_s2.norm();
  return weight_N > 0.0 ? found.fit.force_vector_N / weight_N : std::numeric_limits<double>::infinity();
}

FrameCheck check_frames(const std::vector<StaticPose>& poses, const PoseReading& reading,
                        const ToolIdentification& as_read, const Vec3& gravity_W_m_per_s2, const std::string& source) {
  FrameCheck check;
  check.share_left = share_of_weight_left(as_read, gravity_W_m_per_s2);
  const bool heavier_than_nothing = as_read.load.mass_kg > 0.0;
  check.bad_fit = !(heavier_than_nothing && check.share_left <= most_weight_left);
  if (!check.bad_fit) {
    name_torque_axes(read_as(poses, reading), gravity_W_m_per_s2, check);
    check.bad_fit = !check.torque_axes.empty();
    return check;
  }
  name_gains(read_as(poses, reading), gravity_W_m_per_s2, as_read, check);
  if (check.gains) return check;
  // What was read is no bar: a force that does not turn with the tool fits a bias, with hardly a mass beside it.
  double best_N = std::numeric_limits<double>::infinity();
  for (const PoseReading& other : readings()) {
    if (other.flags() == reading.flags()) continue;
    try {
      const ToolIdentification found = recording::identify_tool(read_as(poses, other), gravity_W_m_per_s2, source);
      const bool fits = found.load.mass_kg > 0.0 && share_of_weight_left(found, gravity_W_m_per_s2) <= most_weight_left;
      // Clearly better than the best so far: the first of equals stays.
      if (!fits || !(found.fit.force_vector_N < 0.9 * best_N)) continue;
      best_N = found.fit.force_vector_N;
      check.repair = other;
      check.repaired = found;
    } catch (const BadData&) {
      continue;  // read so, the orientations do not determine a tool
    }
  }
  if (!check.repair) name_axes(read_as(poses, reading), gravity_W_m_per_s2, check);
  return check;
}

std::string FrameCheck::message(const ToolIdentification& as_read, const std::string& source) const {
  if (!bad_fit) return {};
  if (!torque_axes.empty()) {
    return fmt::format(
        "{}: the torques fit no tool: {:.3g} N m are left per component, and {:.2g} if {} (or all others have): "
        "correct these columns in the file",
        source, as_read.fit.torque_component_Nm, torque_left_Nm, torque_axes);
  }
  std::string text = fmt::format(
      "{}: bad fit: the best tool ({:.3g} kg) leaves {:.3g} N per component, {:.0f} % of its weight, where a usable "
      "set of "
      "poses leaves less than {:.0f} %",
      source, as_read.load.mass_kg, as_read.fit.force_component_N, 100.0 * share_left, 100.0 * most_weight_left);
  if (gains) {
    const Vec3 own = gains->gains(std::nullopt);
    return text + fmt::format(
                      "; with a gain for each of x, y and z, {:.3f}, {:.3f} and {:.3f} of the middle one, {:.2g} N are "
                      "left: load the calibration of this very sensor, and check its cable and amplifier",
                      own.x(), own.y(), own.z(), gains->sigma_N);
  }
  if (!axes.empty()) {
    return text + fmt::format("; if {}, {:.3g} kg leave {:.2g} N per component: correct these columns in the file",
                              axes, axes_mass_kg, axes_left_N);
  }
  if (!repair) {
    return text +
           "; no other frame of the wrench, reading of the orientation, sign or order of the force's axes fits: was "
           "the tool "
           "touched, or are rows of force and orientation of different poses?";
  }
  const std::string flags = repair->flags();
  return text + fmt::format("; if {}, {:.3g} kg leave {:.2g} N per component: give {}",
                            repair->meaning().empty() ? "the file is read as it stands" : repair->meaning(),
                            repaired.load.mass_kg, repaired.fit.force_component_N, flags.empty() ? "no flags" : flags);
}

}  // namespace touchstone::acquisition
