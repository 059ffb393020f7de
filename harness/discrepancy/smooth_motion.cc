#include "harness/discrepancy/smooth_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchstone::discrepancy {
namespace {

constexpr std::array half_windows{2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0};  // of the tracker's period
// Of a confidence interval, in standard deviations: seldom left by noise.
constexpr double interval_deviations = 2.5;
// A window grows by at most so much of the way from where it had to be short: it may not reach across what made it so.
constexpr double window_growth = 0.5;

// The weights are those of all columns of a sample.
template <class Columns>
std::vector<Columns> smooth(const std::vector<double>& t_s, const std::vector<Columns>& series,
                            const std::vector<double>& half_window_s) {
  std::vector<Columns> out(series.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double half_s = half_window_s[i];
    const auto first = std::lower_bound(t_s.begin(), t_s.end(), t_s[i] - half_s) - t_s.begin();
    const auto last = std::upper_bound(t_s.begin(), t_s.end(), t_s[i] + half_s) - t_s.begin();
    constexpr std::ptrdiff_t enough = 5;
    if (last - first < enough) {
      out[i] = series[i];
      continue;
    }
    // The moments of the weights, and of the series with them; only the value in the middle is wanted.
    std::array<double, 5> moments{};
    Columns constant = Columns::Zero();
    Columns linear = Columns::Zero();
    Columns square = Columns::Zero();
    for (auto j = static_cast<std::size_t>(first); j < static_cast<std::size_t>(last); ++j) {
      const double u = (t_s[j] - t_s[i]) / half_s;
      const double share = 1.0 - std::abs(u) * u * u;
      const double weight = share * share * share;
      const double weight_u = weight * u;
      const double weight_uu = weight_u * u;
      moments[0] += weight;
      moments[1] += weight_u;
      moments[2] += weight_uu;
      moments[3] += weight_uu * u;
      moments[4] += weight_uu * u * u;
      constant += weight * series[j];
      linear += weight_u * series[j];
      square += weight_uu * series[j];
    }
    Mat3 normal;
    normal << moments[0], moments[1], moments[2], moments[1], moments[2], moments[3], moments[2], moments[3],
        moments[4];
    const Vec3 row = normal.ldlt().solve(Vec3::UnitX());
    out[i] = row[0] * constant + row[1] * linear + row[2] * square;
  }
  return out;
}

std::vector<Vec3> draw_noise(const std::vector<double>& t_s, const InstrumentDescription& instrument, Random& random) {
  MotionColumns still;
  still.t_s = t_s;
  still.p_W_m.assign(t_s.size(), Vec3::Zero());
  return with_position_noise(still, instrument, random).p_W_m;
}

}  // namespace

MotionSmoother::MotionSmoother(const MotionColumns& motion, const InstrumentDescription& instrument)
    : instrument_(instrument), t_s_(motion.t_s) {
  const std::size_t n = motion.size();
  if (n == 0 || instrument.position_noise_m == 0.0) return;
  Random random(1);
  const std::vector<Vec3> noise = draw_noise(t_s_, instrument, random);
  half_window_s_.assign(n, 0.0);
  std::vector<Eigen::Array3d> low(n, Eigen::Array3d::Constant(-std::numeric_limits<double>::infinity()));
  std::vector<Eigen::Array3d> high(n, Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()));
  std::vector<bool> decided(n, false);
  // Beside the motion the noise, in which the window shows its reach.
  using Both = Eigen::Matrix<double, 3, 2>;
  std::vector<Both> both(n);
  for (std::size_t i = 0; i < n; ++i) both[i] << motion.p_W_m[i], noise[i];
  for (const double periods : half_windows) {
    const std::vector<double> half_s(n, periods / instrument.position_rate_Hz);
    const auto tried = smooth(t_s_, both, half_s);
    double square = 0.0;
    for (const Both& one : tried) square += one.col(1).squaredNorm();
    const double reach_m = interval_deviations * std::sqrt(square / (3.0 * static_cast<double>(n)));
    for (std::size_t i = 0; i < n; ++i) {
      if (decided[i]) continue;
      low[i] = low[i].max(tried[i].col(0).array() - reach_m);
      high[i] = high[i].min(tried[i].col(0).array() + reach_m);
      if ((low[i] > high[i]).any()) {
        decided[i] = true;
      } else {
        half_window_s_[i] = half_s[i];
      }
    }
  }
  const auto bound = [this](std::size_t i, std::size_t neighbour) {
    half_window_s_[i] =
        std::min(half_window_s_[i], half_window_s_[neighbour] + window_growth * std::abs(t_s_[i] - t_s_[neighbour]));
  };
  for (std::size_t i = 1; i < n; ++i) bound(i, i - 1);
  for (std::size_t i = n - 1; i-- > 0;) bound(i, i + 1);
}

MotionColumns MotionSmoother::smoothed(const MotionColumns& motion) const {
  MotionColumns out = motion;
  if (!half_window_s_.empty()) out.p_W_m = smooth(t_s_, motion.p_W_m, half_window_s_);
  return out;
}

std::vector<Vec3> MotionSmoother::left_of_noise(Random& random) const {
  std::vector<Vec3> noise = draw_noise(t_s_, instrument_, random);
  return half_window_s_.empty() ? noise : smooth(t_s_, noise, half_window_s_);
}

MotionColumns smoothed_motion(const MotionColumns& motion, const InstrumentDescription& instrument) {
  return MotionSmoother(motion, instrument).smoothed(motion);
}

}  // namespace touchstone::discrepancy
