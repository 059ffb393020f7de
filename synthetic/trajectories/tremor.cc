#include "synthetic/trajectories/tremor.h"

#include <cmath>
#include <numbers>

#include "harness/base/random.h"

namespace touchstone::synthetic {

Tremor::Tremor(std::uint64_t seed, double rms) : Tremor(seed, rms, lowest_Hz, highest_Hz) {}

Tremor::Tremor(std::uint64_t seed, double rms, double from_Hz, double to_Hz) {
  constexpr int count = 12;
  // A sinusoid of amplitude a has the mean square a^2 / 2.
  amplitude_ = rms * std::sqrt(2.0 / count);
  Random random(seed);
  constexpr double turn = 2.0 * std::numbers::pi;
  for (int i = 0; i < count; ++i) {
    // One frequency from each twelfth of the band.
    const double frequency = from_Hz + (to_Hz - from_Hz) * (i + random.uniform()) / count;
    const double x = random.uniform(0.0, turn);
    const double y = random.uniform(0.0, turn);
    const double z = random.uniform(0.0, turn);
    waves_.push_back({turn * frequency, Vec3(x, y, z)});
  }
}

Vec3 Tremor::at(double t_s) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (const Wave& wave : waves_) {
    const double turned = wave.angular_rad_per_s * t_s;
    sum += Vec3(std::sin(turned + wave.phase_rad.x()), std::sin(turned + wave.phase_rad.y()),
                std::sin(turned + wave.phase_rad.z()));
  }
  return amplitude_ * sum;
}

double Tremor::first_at(double t_s) const noexcept {
  double sum = 0.0;
  for (const Wave& wave : waves_) sum += std::sin(wave.angular_rad_per_s * t_s + wave.phase_rad.x());
  return amplitude_ * sum;
}

}  // namespace touchstone::synthetic
