#include "synthetic/trajectories/hand_scan.h"

#include <algorithm>
#include <cmath>

#include "harness/base/random.h"

namespace touchstone::synthetic {

HandScanPath::HandScanPath(std::uint64_t seed, double side_m, double depth_m, double reaches, double reach_s,
                           double tremor_m)
    : reach_s_(reach_s), tremor_m_(seed, tremor_m) {
  Random random = Random(seed).stream(1);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(reaches))) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random.uniform(-0.5, 0.5) * side_m;
    const double y = random.uniform(-0.5, 0.5) * side_m;
    const double deep = random.uniform(0.5, 1.5) * depth_m;
    places_W_m_.emplace_back(x, y, i % 3 == 0 ? depth_m : -deep);
  }
}

Vec3 HandScanPath::position_W_m(double t_s) const {
  const double t = std::clamp(t_s, 0.0, duration_s());
  const auto reach = std::min(static_cast<std::size_t>(t / reach_s_), places_W_m_.size() - 2);
  const double s = minimum_jerk(t / reach_s_ - static_cast<double>(reach));
  return places_W_m_[reach] + s * (places_W_m_[reach + 1] - places_W_m_[reach]) + tremor_m_.at(t);
}

}  // namespace touchstone::synthetic
