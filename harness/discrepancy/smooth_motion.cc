#include "harness/discrepancy/smooth_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone {
namespace {

std::vector<Vec3> smooth(const std::vector<double>& t_s, const std::vector<Vec3>& series, double half_window_s) {
  std::vector<Vec3> out(series.size());
  std::size_t low = 0;
  std::size_t high = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    while (t_s[low] < t_s[i] - half_window_s) ++low;
    while (high + 1 < series.size() && t_s[high + 1] <= t_s[i] + half_window_s) ++high;
    Mat3 normal = Mat3::Zero();
    Mat3 right = Mat3::Zero();
    for (std::size_t j = low; j <= high; ++j) {
      const double u = (t_s[j] - t_s[i]) / half_window_s;
      const double share = 1.0 - std::abs(u * u * u);
      const Vec3 basis(1.0, u, u * u);
      const double weight = share * share * share;
      normal += weight * basis * basis.transpose();
      right += weight * basis * series[j].transpose();
    }
    constexpr std::size_t enough = 5;
    out[i] = high - low + 1 < enough ? series[i] : Vec3(normal.ldlt().solve(right).row(0).transpose());
  }
  return out;
}

double rms_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

MotionColumns smoothed_motion(const MotionColumns& motion, const InstrumentDescription& instrument) {
  constexpr std::array half_windows{2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0};  // of the tracker's period
  constexpr double margin = 1.1;
  MotionColumns smoothed = motion;
  if (motion.size() == 0 || instrument.position_noise_m == 0.0) return smoothed;
  MotionColumns still = motion;
  std::fill(still.p_W_m.begin(), still.p_W_m.end(), Vec3::Zero());
  Random random(1);
  const std::vector<Vec3> noise = with_position_noise(still, instrument, random).p_W_m;
  for (const double periods : half_windows) {
    const double half_window_s = periods / instrument.position_rate_Hz;
    const auto tried = smooth(motion.t_s, motion.p_W_m, half_window_s);
    const double of_noise = rms_difference(noise, smooth(motion.t_s, noise, half_window_s));
    if (rms_difference(motion.p_W_m, tried) > margin * of_noise) break;
    smoothed.p_W_m = tried;
  }
  return smoothed;
}

}  // namespace touchstone
