// One process recorded twice by a hand that never moves the same way again, for how often a judge calls it two. Springs
// (linear, hardening by Hertz's power 1.5), a damper in parallel, Coulomb friction smooth in the speed, a ring after
// contact in proportion to the speed of contact (Okamura, Cutkosky and Dennerlein 2001), a hum.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "harness/base/random.h"
#include "harness/recording/trajectory.h"

namespace touchstone::perception {

struct PlantedProcess {
  double k_N_per_m = 400.0;
  double power = 1.0;  // force k 5 mm (depth / 5 mm)^power
  double damping_N_s_per_m = 0.0;
  double friction = 0.0;
  double ring_N_s_per_m = 0.0;  // per speed of contact, at 150 Hz, over 30 ms
  double hum_N = 0.0;           // at 120 Hz, in contact
  double noise_N = 0.005;
  double tracker_m = 2e-6;
  double rate_Hz = 1000.0;
  int presses = 8;
  bool slides = false;
  double slide_rad = 0.0;  // direction of sliding in the plane
  double load = 1.0;       // of the hand: depths are multiplied by it
  double pace = 1.0;       // and speeds
};

// Where the seeds of the tests by night begin: TOUCHSTONE_PERCEPTION_SEED, else 0.
inline std::uint64_t first_seed() {
  const char* const text = std::getenv("TOUCHSTONE_PERCEPTION_SEED");
  return text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
}

inline recording::Recording planted(const PlantedProcess& process, std::uint64_t seed) {
  Random random(seed);
  recording::Recording recording;
  recording.source = "planted";
  constexpr double two_pi = 2.0 * std::numbers::pi;
  double t = 0.0;
  double ring_since_s = 1e9;
  double ring_N = 0.0;
  double before_m = -1.0;
  const double dt = 1.0 / process.rate_Hz;
  const Vec3 along(std::cos(process.slide_rad), std::sin(process.slide_rad), 0.0);
  for (int press = 0; press < process.presses; ++press) {
    const double duration_s = random.uniform(0.7, 1.1) / process.pace * (process.slides ? 3.0 : 1.0);
    const double deepest_m = process.load * random.uniform(0.8, 1.1) * 2.0 / process.k_N_per_m;
    const double strokes = process.slides ? std::floor(random.uniform(2.0, 4.0)) : 0.0;
    const double phase = random.uniform(0.0, two_pi);
    for (double s = 0.0; s < duration_s; s += dt, t += dt) {
      const double share = s / duration_s;
      // Down within a third, held as it slides, and up; a third of the time in the air.
      const double way = process.slides ? std::clamp(1.6 * std::sin(std::numbers::pi * share), 0.0, 1.0)
                                        : 0.5 - 0.5 * std::cos(two_pi * share);
      const double depth_m = (deepest_m + 0.002) * way - 0.002;
      const double speed_m_per_s = before_m > -1.0 ? (depth_m - before_m) / dt : 0.0;
      const double angle = two_pi * strokes * share + phase;
      const double slide_m_per_s = 0.015 * two_pi * strokes / duration_s * std::cos(angle);
      if (before_m <= 0.0 && depth_m > 0.0) ring_since_s = 0.0, ring_N = process.ring_N_s_per_m * speed_m_per_s;
      before_m = depth_m;
      double load_N = 0.0;
      if (depth_m > 0.0) {
        load_N = process.k_N_per_m * 0.005 * std::pow(depth_m / 0.005, process.power) +
                 process.damping_N_s_per_m * speed_m_per_s * std::min(1.0, depth_m / 0.0005) +
                 ring_N * std::exp(-ring_since_s / 0.03) * std::sin(two_pi * 150.0 * ring_since_s) +
                 process.hum_N * std::sin(two_pi * 120.0 * t);
        ring_since_s += dt;
      }
      const double drag_N =
          process.slides && depth_m > 0.0 ? process.friction * load_N * std::tanh(slide_m_per_s / 0.003) : 0.0;
      const auto noise = [&random](double sigma) {
        const double x = random.normal();
        const double y = random.normal();
        return Vec3(sigma * Vec3(x, y, random.normal()));
      };
      Vec3 place = process.slides ? Vec3(0.015 * std::sin(angle) * along) : Vec3(Vec3::Zero());
      place.z() = -depth_m;
      recording.motion.t_s.push_back(t);
      recording.motion.p_W_m.push_back(place + noise(process.tracker_m));
      recording.f_W_N.push_back(Vec3(0.0, 0.0, load_N) - drag_N * along + noise(process.noise_N));
    }
  }
  return recording;
}

// Ten kinds of surface.
inline std::vector<PlantedProcess> kinds_of_surface() {
  return {{},
          {.k_N_per_m = 1500.0},
          {.power = 1.5},
          {.damping_N_s_per_m = 4.0},
          {.ring_N_s_per_m = 4.0},
          {.hum_N = 0.02},
          {.slides = true},
          {.friction = 0.3, .slides = true},
          {.k_N_per_m = 1000.0, .friction = 0.6, .slides = true},
          {.damping_N_s_per_m = 2.0, .friction = 0.3, .slides = true}};
}

}  // namespace touchstone::perception
