#include "harness/discrepancy/texture_spectrum.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/discrepancy/local_stiffness.h"

namespace touchstone::discrepancy {
namespace {

constexpr std::size_t most_samples = 1200;
constexpr int directions = 36;
constexpr double finest = 1.0 / 60.0;  // of the extent

// Cosine and sine of every sample's phase, wave number after wave number, without a call of either for each.
struct Waves {
  Eigen::ArrayXd cosine;
  Eigen::ArrayXd sine;
  Waves(const Eigen::ArrayXd& along, double wave_number, double step)
      : cosine((wave_number * along).cos()),
        sine((wave_number * along).sin()),
        turn_cosine_((step * along).cos()),
        turn_sine_((step * along).sin()) {}
  void advance() {
    next_ = cosine * turn_cosine_ - sine * turn_sine_;
    sine = sine * turn_cosine_ + cosine * turn_sine_;
    cosine.swap(next_);
  }

 private:
  Eigen::ArrayXd turn_cosine_;
  Eigen::ArrayXd turn_sine_;
  Eigen::ArrayXd next_;
};

}  // namespace

std::vector<TexturePeak> texture_peaks(const recording::Recording& recording, const rendering::Prediction& current,
                                       double extent_m, std::size_t count) {
  std::vector<Eigen::Vector3d> seen;  // x, y, height
  const std::size_t stride = std::max<std::size_t>(1, recording.size() / most_samples);
  const std::vector<std::size_t> pressing = pressing_samples(current, stride);
  const std::vector<double> stiffness_N_per_m = stiffness_at(current, pressing);
  for (std::size_t k = 0; k < pressing.size(); ++k) {
    const std::size_t i = pressing[k];
    const Vec3& n = current.n_W[i];
    // The wave is the surface's: it is seen at the foot of a point tip, up to a constant for a ball on a smooth body.
    const Vec3 foot_W_m = recording.motion.p_W_m[i] + current.depth_m[i] * n;
    seen.emplace_back(foot_W_m.x(), foot_W_m.y(), n.dot(recording.f_W_N[i] - current.f_W_N[i]) / stiffness_N_per_m[k]);
  }
  std::vector<TexturePeak> peaks;
  if (seen.size() < 30 || !(extent_m > 0.0)) return peaks;
  const Eigen::Map<const Eigen::Matrix3Xd> columns(seen.front().data(), 3, static_cast<Eigen::Index>(seen.size()));
  const Eigen::ArrayXd x = columns.row(0);
  const Eigen::ArrayXd y = columns.row(1);
  Eigen::ArrayXd height_m = columns.row(2);
  height_m -= height_m.mean();
  const double total = height_m.matrix().squaredNorm();
  std::vector<TexturePeak> all;
  // Wave numbers in steps that move the phase across the scan by a third of a turn: no peak falls between two.
  const double step = 1.0 / (3.0 * extent_m);
  const auto wave_number = [&](int m) { return 0.5 / extent_m + m * step; };
  const auto count_of = static_cast<int>(std::ceil((1.0 / (finest * extent_m) - wave_number(0)) / step));
  // Finer turns for short waves: the phase at the scan's border must not jump either.
  const auto turns = [&](int m) {
    return 1 + static_cast<int>(wave_number(m) * extent_m * std::numbers::pi / directions * 1.5);
  };
  for (int first = 0, last = 0; first < count_of; first = last) {
    for (last = first + 1; last < count_of && turns(last) == turns(first);) ++last;
    const int all_turns = directions * turns(first);
    for (int d = 0; d < all_turns; ++d) {
      const double direction = std::numbers::pi * d / all_turns;
      // From one wave number to the next every sample's wave turns by the same angle.
      const Eigen::ArrayXd along = 2.0 * std::numbers::pi * (std::cos(direction) * x + std::sin(direction) * y);
      Waves waves(along, wave_number(first), step);
      for (int m = first; m < last; ++m, waves.advance()) {
        const double c = waves.cosine.matrix().dot(height_m.matrix());
        const double sn = waves.sine.matrix().dot(height_m.matrix());
        const double cc = waves.cosine.matrix().squaredNorm();
        const double ss = waves.sine.matrix().squaredNorm();
        const double cs = waves.cosine.matrix().dot(waves.sine.matrix());
        const double determinant = cc * ss - cs * cs;
        if (determinant <= 1e-9 * cc * ss) continue;
        const double a = (c * ss - sn * cs) / determinant;  // of the cosine
        const double b = (sn * cc - c * cs) / determinant;  // of the sine
        all.push_back({std::hypot(a, b), 1.0 / wave_number(m), direction, std::atan2(a, b), (a * c + b * sn) / total});
      }
    }
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

}  // namespace touchstone::discrepancy
