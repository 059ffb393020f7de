#include "experiments/press_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "synthetic/trajectories/tremor.h"

namespace touchstone::experiments {

std::vector<double> press_depths_m(const PressMotion& motion, double rate_Hz, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> stroke_m;
  std::vector<double> onset_s;
  for (int press = 0; press < motion.presses; ++press) {
    stroke_m.push_back(motion.stroke_m * (1.0 + motion.stroke_spread * random.normal()));
    onset_s.push_back(static_cast<double>(press) / motion.beat_Hz + motion.onset_spread_s * random.normal());
  }
  const synthetic::Tremor tremor(random.next_u64(), motion.tremor_m);
  const double length_s = 1.0 / motion.beat_Hz;
  const auto samples = static_cast<std::size_t>(std::round(motion.duration_s() * rate_Hz));
  std::vector<double> depth_m(samples, 0.0);
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / rate_Hz;
    double press_m = 0.0;
    for (std::size_t p = 0; p < onset_s.size(); ++p) {
      const double phase = (t - onset_s[p]) / length_s;
      if (phase <= 0.0 || phase >= 1.0) continue;
      press_m = std::max(press_m, stroke_m[p] * 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * phase)));
    }
    if (press_m == 0.0) continue;
    const double shake_m = tremor.first_at(t);
    // A resting finger keeps contact: tremor only shows while it presses.
    depth_m[n] = std::max(0.0, press_m + shake_m * std::min(1.0, press_m / (0.1 * motion.stroke_m)));
  }
  return depth_m;
}

}  // namespace touchstone::experiments
