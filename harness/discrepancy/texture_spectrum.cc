#include "harness/discrepancy/texture_spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone {
namespace {

constexpr std::size_t most_samples = 1200;
constexpr int directions = 36;
constexpr double finest = 1.0 / 60.0;  // of the extent

}  // namespace

std::vector<TexturePeak> texture_peaks(const Recording& recording, const Prediction& current, double extent_m,
                                       std::size_t count) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> height_m;
  const std::size_t stride = std::max<std::size_t>(1, recording.size() / most_samples);
  for (std::size_t i = 0; i < recording.size(); i += stride) {
    const Vec3& n = current.n_W[i];
    if (n.isZero() || current.depth_m[i] <= 0.0 || current.normal_N[i] <= 0.0) continue;
    const double stiffness = current.normal_N[i] / current.depth_m[i];
    x.push_back(recording.motion.p_W_m[i].x());
    y.push_back(recording.motion.p_W_m[i].y());
    height_m.push_back(n.dot(recording.f_W_N[i] - current.f_W_N[i]) / stiffness);
  }
  std::vector<TexturePeak> peaks;
  if (height_m.size() < 30 || !(extent_m > 0.0)) return peaks;
  double mean = 0.0;
  for (const double h : height_m) mean += h / static_cast<double>(height_m.size());
  double total = 0.0;
  for (double& h : height_m) {
    h -= mean;
    total += h * h;
  }
  // Wave numbers in steps that move the phase across the scan by a third of a turn: no peak falls between two.
  std::vector<TexturePeak> all;
  const double step = 1.0 / (3.0 * extent_m);
  double wave_number = 0.5 / extent_m;
  while (wave_number < 1.0 / (finest * extent_m)) {
    for (int d = 0; d < directions; ++d) {
      // Finer turns for short waves: the phase at the scan's border must not jump either.
      const int turns = 1 + static_cast<int>(wave_number * extent_m * std::numbers::pi / directions * 1.5);
      for (int s = 0; s < turns; ++s) {
        const double direction = std::numbers::pi * (d + static_cast<double>(s) / turns) / directions;
        const double kx = 2.0 * std::numbers::pi * wave_number * std::cos(direction);
        const double ky = 2.0 * std::numbers::pi * wave_number * std::sin(direction);
        double c = 0.0;
        double sn = 0.0;
        double cc = 0.0;
        double ss = 0.0;
        double cs = 0.0;
        for (std::size_t i = 0; i < height_m.size(); ++i) {
          const double phase = kx * x[i] + ky * y[i];
          const double cosine = std::cos(phase);
          const double sine = std::sin(phase);
          c += height_m[i] * cosine;
          sn += height_m[i] * sine;
          cc += cosine * cosine;
          ss += sine * sine;
          cs += cosine * sine;
        }
        const double determinant = cc * ss - cs * cs;
        if (determinant <= 1e-9 * cc * ss) continue;
        const double a = (c * ss - sn * cs) / determinant;  // of the cosine
        const double b = (sn * cc - c * cs) / determinant;  // of the sine
        all.push_back({std::hypot(a, b), 1.0 / wave_number, direction, std::atan2(a, b), (a * c + b * sn) / total});
      }
    }
    wave_number += step;
  }
  std::sort(all.begin(), all.end(), [](const TexturePeak& p, const TexturePeak& q) { return p.power > q.power; });
  for (const TexturePeak& peak : all) {
    if (peaks.size() == count) break;
    const auto beside = [&](const TexturePeak& kept) {
      const double dx =
          std::cos(peak.direction_rad) / peak.wavelength_m - std::cos(kept.direction_rad) / kept.wavelength_m;
      const double dy =
          std::sin(peak.direction_rad) / peak.wavelength_m - std::sin(kept.direction_rad) / kept.wavelength_m;
      return std::hypot(dx, dy) < 1.0 / extent_m;
    };
    if (std::none_of(peaks.begin(), peaks.end(), beside)) peaks.push_back(peak);
  }
  return peaks;
}

}  // namespace touchstone
