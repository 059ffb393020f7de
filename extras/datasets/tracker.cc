#include "tracker.h"

#include <algorithm>
#include <cmath>

#include "coloured_noise.h"

namespace touchstone::datasets {

Tracker Tracker::perfect() {
  Tracker tracker;
  tracker.noise_m = 0.0;
  tracker.wander_m = 0.0;
  tracker.orientation_noise_rad = 0.0;
  return tracker;
}

PoseMeasurement Tracker::measure(const std::function<Pose(double)>& pose, double duration_s, std::uint64_t seed) const {
  const double period = 1.0 / rate_Hz;
  const Random root(seed);
  ColouredNoise noise(root.stream(0), noise_m, 0.0, period);
  ColouredNoise wander(root.stream(1), wander_m, wander_time_constant_s, period);
  ColouredNoise turning(root.stream(2), orientation_noise_rad, 0.0, period);
  Random clock = root.stream(3);
  PoseMeasurement out;
  const auto count = static_cast<std::size_t>(std::floor(duration_s * rate_Hz * (1.0 + 1e-12))) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double off = jitter_s * clock.uniform(-1.0, 1.0);
    const double exposed = std::clamp(static_cast<double>(i) / rate_Hz + off, 0.0, duration_s);
    const Pose truth = pose(exposed);
    const Vec3 turn = turning.next();
    const double angle = turn.norm();
    const Quat error = angle > 0.0 ? Quat(Eigen::AngleAxisd(angle, turn / angle)) : Quat::Identity();
    out.t_s.push_back(exposed + lag_s);
    out.truth_W_m.push_back(truth.p_W_m);
    out.noise_W_m.push_back(noise.next());
    out.wander_W_m.push_back(wander.next());
    out.measured_W_m.push_back(truth.p_W_m + out.noise_W_m.back() + out.wander_W_m.back());
    out.truth_WS.push_back(truth.q_WS);
    out.measured_WS.push_back(angle > 0.0 ? (truth.q_WS * error).normalized() : truth.q_WS);
  }
  return out;
}

}  // namespace touchstone::datasets
