// Textures and slides whose truth is known.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "harness/recording/trajectory.h"
#include "line_spectrum.h"
#include "texture_model.h"

namespace touchstone::texture {

inline constexpr double made_mass_kg = 0.05;

// One resonance: poles at `radius` and +-`frequency_Hz`.
inline std::vector<double> resonance(double frequency_Hz, double radius, double rate_Hz) {
  return {1.0, -2.0 * radius * std::cos(2.0 * std::numbers::pi * frequency_Hz / rate_Hz), radius * radius};
}

// A rectangle up to 0.2 m/s and 2 N, silent at rest and without force: from 60 Hz at its slow end to 180 Hz at its fast
// one, and louder with the force.
inline TextureModel made_texture(double rate_Hz = 1000.0) {
  TextureModel model;
  model.material = "made & <told>";
  model.rate_Hz = rate_Hz;
  model.mu = 0.35;
  model.largest_speed_m_per_s = 0.2;
  model.largest_force_N = 2.0;
  const auto add = [&](double speed, double force, double frequency_Hz, double variance) {
    TextureNode node;
    node.speed_m_per_s = speed;
    node.force_N = force;
    node.ar_rad = line_spectral_frequencies(resonance(frequency_Hz, 0.93, rate_Hz));
    node.variance = variance;
    model.nodes.push_back(std::move(node));
  };
  add(0.0, 0.0, 60.0, 0.0);
  add(0.2, 0.0, 180.0, 0.0);
  add(0.2, 2.0, 180.0, 0.4);
  add(0.0, 2.0, 60.0, 0.0);
  add(0.1, 1.0, 120.0, 0.1);
  model.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  return model;
}

// One hold of a slide: circles at one speed under one load.
struct Hold {
  double speed_m_per_s = 0.0;
  double load_N = 0.0;
  double seconds = 0.0;
};

// A tip that circles over a plane with Coulomb friction, and a vibration across its path: standard library's noise
// through the given filters, so that nothing of the code under test makes it. `filters`: of each hold, with its
// variance of the acceleration.
inline recording::Recording made_slide(const std::vector<Hold>& holds,
                                       const std::vector<std::pair<std::vector<double>, double>>& filters, double mu,
                                       double rate_Hz, std::uint64_t seed, const Quat& turn = Quat::Identity()) {
  constexpr double radius_m = 0.03;
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  recording::Recording made;
  made.source = "made.csv";
  double angle = 0.0, t_s = 0.0;
  for (std::size_t h = 0; h < holds.size(); ++h) {
    const std::vector<double>& a = filters[h].first;
    std::vector<double> past(a.size(), 0.0);
    for (int i = 0; i < static_cast<int>(holds[h].seconds * rate_Hz); ++i) {
      past[0] = std::sqrt(filters[h].second) * normal(engine);
      for (std::size_t k = 1; k < a.size(); ++k) past[0] -= a[k] * past[k];
      const Vec3 outward(std::cos(angle), std::sin(angle), 0.0), along(-std::sin(angle), std::cos(angle), 0.0);
      const Vec3 force =
          holds[h].load_N * Vec3::UnitZ() - mu * holds[h].load_N * along + made_mass_kg * past[0] * outward;
      made.motion.t_s.push_back(t_s);
      made.motion.p_W_m.push_back(turn * (radius_m * outward));
      made.f_W_N.push_back(turn * force);
      for (std::size_t k = a.size() - 1; k > 0; --k) past[k] = past[k - 1];
      angle += holds[h].speed_m_per_s / radius_m / rate_Hz;
      t_s += 1.0 / rate_Hz;
    }
  }
  return made;
}

}  // namespace touchstone::texture
