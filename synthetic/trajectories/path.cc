#include "synthetic/trajectories/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone::synthetic {

recording::InTrajectory sample(const Path& path, double rate_Hz) {
  // A duration that is a whole number of periods but for rounding keeps its last sample.
  const double steps = std::floor(path.duration_s() * rate_Hz * (1.0 + 1e-12));
  if (!(rate_Hz > 0.0) || !(steps >= 1.0) || steps > 1e8) {
    throw UsageError(fmt::format("sampling {} s at {} Hz makes no trajectory; 2 to 100 million samples can be made",
                                 path.duration_s(), rate_Hz));
  }
  recording::InTrajectory trajectory;
  const auto count = static_cast<std::size_t>(steps) + 1;
  trajectory.motion.t_s.reserve(count);
  trajectory.motion.p_W_m.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    trajectory.motion.t_s.push_back(t);
    trajectory.motion.p_W_m.push_back(path.position_W_m(t));
  }
  return trajectory;
}

double minimum_jerk(double fraction) noexcept {
  const double s = std::clamp(fraction, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

double to_and_fro(double passes) noexcept { return std::abs(passes - 2.0 * std::round(0.5 * passes)); }

}  // namespace touchstone::synthetic
