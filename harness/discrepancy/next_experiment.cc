#include "harness/discrepancy/next_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Prediction;

namespace {

constexpr double rate_Hz = 250.0;
constexpr double needed_separation = 1.5;

// The place to work at: where the recording was in contact, its normal, and how deep and far it went.
struct Site {
  Vec3 centre_W_m = Vec3::Zero();
  Vec3 n_W = Vec3::UnitZ();
  Vec3 u_W = Vec3::UnitX();
  Vec3 v_W = Vec3::UnitY();
  double depth_m = 0.0;
  double reach_m = 0.0;
  double speed_m_per_s = 0.0;  // along the surface, median in contact
  Quat q_WS = Quat::Identity();
};

// Over a tenth of a second, in which a tracker's noise is small against the way.
double sliding_speed_m_per_s(const Recording& recording, const Prediction& prediction, const Vec3& n_W) {
  constexpr double over_s = 0.1;
  std::vector<double> speeds;
  std::size_t before = 0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double elapsed_s = recording.motion.t_s[i] - recording.motion.t_s[before];
    if (elapsed_s < over_s) continue;
    const Vec3 way = recording.motion.p_W_m[i] - recording.motion.p_W_m[before];
    const bool touching = !prediction.n_W[i].isZero() && !prediction.n_W[before].isZero();
    if (touching) speeds.push_back((way - n_W.dot(way) * n_W).norm() / elapsed_s);
    ++before;
  }
  if (speeds.empty()) return 0.0;
  return stats::upper_median(std::move(speeds));
}

Site find_site(const Recording& recording, const Prediction& prediction) {
  Site site;
  Vec3 sum_p = Vec3::Zero();
  Vec3 sum_n = Vec3::Zero();
  std::size_t count = 0;
  Box3 box;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (prediction.n_W[i].isZero()) continue;
    sum_p += recording.motion.p_W_m[i];
    sum_n += prediction.n_W[i];
    box.extend(recording.motion.p_W_m[i]);
    site.depth_m = std::max(site.depth_m, prediction.depth_m[i]);
    ++count;
  }
  if (count == 0) return site;
  const Vec3 mean = sum_p / static_cast<double>(count);
  // The sample nearest to the mean lies on the object; the mean itself may not.
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < recording.size(); ++i) {
    const double distance = (recording.motion.p_W_m[i] - mean).norm();
    if (prediction.n_W[i].isZero() || distance >= nearest) continue;
    nearest = distance;
    site.n_W = prediction.n_W[i];
    site.centre_W_m = recording.motion.p_W_m[i] + prediction.depth_m[i] * site.n_W;
    if (!recording.motion.q_WS.empty()) site.q_WS = recording.motion.q_WS[i];
  }
  site.speed_m_per_s = sliding_speed_m_per_s(recording, prediction, site.n_W);
  site.u_W = site.n_W.unitOrthogonal();
  site.v_W = site.n_W.cross(site.u_W);
  site.reach_m = 0.25 * box.diagonal().norm();
  return site;
}

struct Gesture {
  std::string what;
  double duration_s;
  // Place relative to the site in (u, v, height above the surface), and the tool's turn.
  std::function<Vec3(double)> place;
  std::function<Quat(double)> turn;
};

Quat no_turn(double) { return Quat::Identity(); }

Quat tilt(double t_s) {
  const double angle = 40.0 * std::numbers::pi / 180.0;
  return Quat(Eigen::AngleAxisd(angle * std::sin(2.0 * std::numbers::pi * t_s / 6.0), Vec3::UnitX()) *
              Eigen::AngleAxisd(angle * std::cos(2.0 * std::numbers::pi * t_s / 4.0) - angle, Vec3::UnitY()));
}

std::vector<Gesture> repertoire(const Site& site) {
  const double d = site.depth_m;
  const double r = site.reach_m;
  const double tau = 2.0 * std::numbers::pi;
  // Circles from a fifth of the recorded speed to three times of it, within what a hand does on so large a circle.
  constexpr double growth = 15.0;
  const double slowest = std::clamp(site.speed_m_per_s / 5.0, 0.02 * r, 0.4 * r);
  return {
      {"free air, the tool turned about x and y by 40 degrees", 12.0,
       [=](double) { return Vec3(0.0, 0.0, 3.0 * d + r); }, tilt},
      {"pressing while the tool is turned about x and y by 40 degrees", 12.0,
       [=](double t) { return Vec3(0.0, 0.0, -d * 0.5 * (1.0 - std::cos(tau * t / 1.5))); }, tilt},
      {"presses of growing depth at growing speed", 14.0,
       [=](double t) {
         // The phase of a chirp: 0.3 + 0.24 t cycles a second.
         const double cycles = 0.3 * t + 0.12 * t * t;
         return Vec3(0.0, 0.0, 0.3 * d - d * (0.5 + 0.8 * t / 14.0) * 0.5 * (1.0 - std::cos(tau * cycles)));
       },
       no_turn},
      {"press quickly and hold for eight seconds, then leave", 11.0,
       [=](double t) {
         const double press = std::clamp(t / 0.15, 0.0, 1.0) - std::clamp((t - 8.5) / 0.15, 0.0, 1.0);
         return Vec3(0.0, 0.0, 0.5 * d - 1.5 * d * press);
       },
       no_turn},
      {fmt::format("circles at constant load, from {:.2g} to {:.2g} mm/s", 1e3 * slowest, 1e3 * growth * slowest), 16.0,
       [=](double t) {
         // The speed grows as v0 g^(t / T); the angle is its integral over the radius, v0 / r T / ln g (g^(t / T) - 1).
         const double turned = slowest / r * 16.0 / std::log(growth) * (std::pow(growth, t / 16.0) - 1.0);
         return Vec3(r * std::cos(turned), r * std::sin(turned), -0.7 * d);
       },
       no_turn},
      {"strokes there and back along four directions at three speeds and three loads", 24.0,
       [=](double t) {
         const int stroke = static_cast<int>(t / 2.0);
         const double direction = std::numbers::pi * (stroke % 4) / 4.0;
         const double fast = 0.5 * std::pow(2.0, stroke / 4);
         const double s = r * std::sin(tau * fast * (t - 2.0 * stroke) / 2.0);
         return Vec3(s * std::cos(direction), s * std::sin(direction), -d * (0.3 + 0.3 * (stroke % 3)));
       },
       no_turn},
  };
}

// Each gesture begins and ends in free air, above its first and last place, so that what acts in contact alone shows.
MotionColumns perform(const Gesture& gesture, const Site& site, bool with_orientation) {
  constexpr double free_s = 1.0;
  constexpr double approach_s = 1.0;
  const double clear_m = 2.0 * site.depth_m + 0.2 * site.reach_m;
  const double lead_s = free_s + approach_s;
  MotionColumns motion;
  const auto samples = static_cast<std::size_t>((gesture.duration_s + 2.0 * lead_s) * rate_Hz);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t_s = static_cast<double>(i) / rate_Hz;
    const double into_s = std::clamp(t_s - lead_s, 0.0, gesture.duration_s);
    Vec3 place = gesture.place(into_s);
    const double outside_s = std::abs(t_s - lead_s - into_s);
    // Minimum jerk (Flash and Hogan 1985).
    const double u = std::min(1.0, outside_s / approach_s);
    const double lift = u * u * u * (10.0 + u * (6.0 * u - 15.0));
    place.z() += lift * std::max(0.0, clear_m - place.z());
    motion.t_s.push_back(t_s);
    motion.p_W_m.push_back(site.centre_W_m + place.x() * site.u_W + place.y() * site.v_W + place.z() * site.n_W);
    if (with_orientation) motion.q_WS.push_back(gesture.turn(t_s) * site.q_WS);
  }
  return motion;
}

}  // namespace

std::optional<NextExperiment> propose_experiment(const Recording& recording, const Prediction& prediction,
                                                 const rendering::Model& one, const rendering::Model& other,
                                                 const rendering::MakePredictor& make, double force_noise_N,
                                                 double position_noise_m) {
  const Site site = find_site(recording, prediction);
  if (site.depth_m <= 0.0 || site.reach_m <= 0.0) return std::nullopt;
  // A tracker's error moves the predicted force by the stiffness times it, where the tip touches.
  const double by_position_N = one.parameters.at("stiffness_N_per_m") * position_noise_m;
  force_noise_N = std::max(force_noise_N, 1e-12);
  std::optional<NextExperiment> best;
  for (const Gesture& gesture : repertoire(site)) {
    NextExperiment proposal{perform(gesture, site, !recording.motion.q_WS.empty()), gesture.what, 0.0};
    const auto predictor = make(proposal.motion);
    const Prediction a = predictor->predict(one);
    const Prediction b = predictor->predict(other);
    // A constant difference would be taken up by refitting either: only what varies separates them.
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < a.f_W_N.size(); ++i)
      mean += (a.f_W_N[i] - b.f_W_N[i]) / static_cast<double>(a.f_W_N.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < a.f_W_N.size(); ++i) {
      const bool touches = !a.n_W[i].isZero() || !b.n_W[i].isZero();
      const double noise_N = std::hypot(force_noise_N, touches ? by_position_N : 0.0);
      sum += (a.f_W_N[i] - b.f_W_N[i] - mean).squaredNorm() / (noise_N * noise_N);
    }
    // Root mean square over samples and three axes of the difference over its noise.
    proposal.separation = std::sqrt(sum / (3.0 * static_cast<double>(a.f_W_N.size())));
    if (!best || proposal.separation > best->separation) best = std::move(proposal);
  }
  if (best && best->separation < needed_separation) best.reset();
  return best;
}

}  // namespace touchstone::discrepancy
