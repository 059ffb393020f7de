// One process as the hand meets it: force and motion in the frame of pressing, on one uniform clock.
#pragma once

#include <string>
#include <vector>

#include "harness/recording/trajectory.h"

namespace touchstone::perception {

// Added to the speed of sliding as a square, so that its direction goes to nought at rest.
inline constexpr double rest_m_per_s = 0.001;

// Axis 0 is the outward direction of pressing, 1 and 2 lie across it. SI units; force ON the probe BY the object.
struct FeltSeries {
  std::string name;  // where it comes from, for messages
  double rate_Hz = 0.0;
  double start_s = 0.0;         // time of the first sample in the recording
  std::vector<double> depth_m;  // against the outward direction; any origin. Smoothed over 20 ms
  std::vector<double> rate_of_depth_m_per_s;
  // Direction of sliding along axis 1 and 2: s_i / sqrt(s^2 + (1 mm/s)^2), so that rest has none and noise of the speed
  // hardly shows while sliding.
  std::vector<double> slide_x;
  std::vector<double> slide_y;
  std::vector<double> slide_m_per_s;                             // speed of sliding
  std::vector<double> place_m[2];                                // along axis 1 and 2, smoothed like the depth
  Vec3 axis[3] = {Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY()};  // in the object's frame
  std::vector<double> force_N[3];
  // Standard deviation of the tracker's noise along axis 0 before smoothing, as if white.
  double position_noise_m = 0.0;
  std::size_t smoothed_samples = 1;  // that each depth is the mean of
  // Of a force that a model gives along replay_path(): samples of its parabola. 0: measured, beside a path whose noise
  // the object does not see.
  std::size_t replayed_samples = 0;
  bool same_clock = true;  // false: samples were interpolated to an even clock

  [[nodiscard]] std::size_t size() const noexcept { return depth_m.size(); }
  [[nodiscard]] double t_s(std::size_t i) const noexcept { return start_s + static_cast<double>(i) / rate_Hz; }
};

// Faster than 2.3 mm/s.
inline bool slides(const FeltSeries& felt, std::size_t i) {
  return felt.slide_x[i] * felt.slide_x[i] + felt.slide_y[i] * felt.slide_y[i] > 0.92 * 0.92;
}

// The outward direction of pressing: of the mean force in contact, without the friction that one way of sliding leaves
// in it where a hand slides more that way than back (a tilt of 5 degrees makes 3 mm of depth of a stroke of 40 mm).
// Throws BadData where the force has no direction.
Vec3 pressing_direction(const recording::Recording& recording);

// Positions and velocities are means and slopes over 20 ms, so that a tracker's noise does not look like a vibration
// of the object. Samples are interpolated to an even clock if an interval differs from the median by more than 5 %.
// Throws BadData for no force, values that are not finite or beyond 1e9 N and 1e6 m, time that does not advance, a hole
// of more than 20 intervals, or fewer than 50 samples.
FeltSeries felt_series(const recording::Recording& recording, const Vec3& outward);

// The motion of `lag_s` ago beside the force of now: what an object with that delay answers to. The first samples keep
// the first motion.
FeltSeries with_lag(const FeltSeries& felt, double lag_s);

}  // namespace touchstone::perception
