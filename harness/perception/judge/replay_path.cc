#include "harness/perception/judge/replay_path.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::perception {
namespace {

constexpr double longest_s = 0.02;

// The parabola's value at the middle by least squares over the samples' own times; fewer samples at the ends.
Vec3 smoothed_at(const MotionColumns& motion, std::size_t i, std::size_t half) {
  const std::size_t reach = std::min({half, i, motion.size() - 1 - i});
  if (reach < 2) return motion.p_W_m[i];
  // Moments of the time from the middle, in units of the reach, and of time and place.
  std::array<double, 5> m{};
  std::array<Vec3, 3> place{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  const double unit_s = motion.t_s[i + reach] - motion.t_s[i - reach];
  for (std::size_t j = i - reach; j <= i + reach; ++j) {
    const double s = (motion.t_s[j] - motion.t_s[i]) / unit_s;
    const Vec3 p = motion.p_W_m[j] - motion.p_W_m[i];
    double power = 1.0;
    for (std::size_t e = 0; e < m.size(); ++e, power *= s) {
      m[e] += power;
      if (e < place.size()) place[e] += power * p;
    }
  }
  // Cramer's rule for the constant of  [m0 m1 m2; m1 m2 m3; m2 m3 m4] (c, v, a) = place.
  const double a = m[2] * m[4] - m[3] * m[3];
  const double b = m[1] * m[4] - m[2] * m[3];
  const double c = m[1] * m[3] - m[2] * m[2];
  const double determinant = m[0] * a - m[1] * b + m[2] * c;
  return motion.p_W_m[i] + (a * place[0] - b * place[1] + c * place[2]) / determinant;
}

}  // namespace

std::vector<double> parabola_weights(std::size_t samples) {
  const auto m = static_cast<double>(samples / 2);
  std::vector<double> weights(samples, 1.0);
  if (samples < 5) {
    weights.assign(samples, 0.0);
    weights[samples / 2] = 1.0;
    return weights;
  }
  for (std::size_t j = 0; j < samples; ++j) {
    const double at = static_cast<double>(j) - m;
    weights[j] =
        (3.0 * (3.0 * m * m + 3.0 * m - 1.0) - 15.0 * at * at) / ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
  }
  return weights;
}

double white_noise_of(const std::vector<double>& x) {
  double squares = 0.0;
  for (std::size_t i = 4; i < x.size(); ++i) {
    const double fourth = x[i] - 4.0 * x[i - 1] + 6.0 * x[i - 2] - 4.0 * x[i - 3] + x[i - 4];
    squares += fourth * fourth;
  }
  return std::sqrt(squares / (70.0 * static_cast<double>(x.size() - 4)));
}

ReplayPath replay_path(const MotionColumns& recorded) {
  ReplayPath result{recorded, 1};
  const std::size_t n = recorded.size();
  if (n < 50) return result;
  double noise_m2 = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column(n);
    for (std::size_t i = 0; i < n; ++i) column[i] = recorded.p_W_m[i][axis];
    noise_m2 += std::pow(white_noise_of(column), 2);
  }
  const double interval_s = (recorded.t_s.back() - recorded.t_s.front()) / static_cast<double>(n - 1);
  const auto longest = static_cast<std::size_t>(std::round(0.5 * longest_s / interval_s));
  // Six standard errors of a mean square of n samples.
  const double chance = 1.0 + 6.0 * std::sqrt(2.0 / static_cast<double>(n));
  for (std::size_t half = 2; half <= longest; ++half) {
    std::vector<Vec3> smooth(n);
    double residual_m2 = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      smooth[i] = smoothed_at(recorded, i, half);
      residual_m2 += (recorded.p_W_m[i] - smooth[i]).squaredNorm() / static_cast<double>(n);
    }
    // What white noise leaves beside a projection is its variance less the weight of the middle.
    const double own_weight = parabola_weights(2 * half + 1)[half];
    if (residual_m2 > noise_m2 * (1.0 - own_weight) * chance) break;
    result.motion.p_W_m = std::move(smooth);
    result.samples = 2 * half + 1;
  }
  return result;
}

}  // namespace touchstone::perception
