// Haptic data matrix M = (M_t), t = 1..T (Shao, Wu and Ouyang, "An objective quality evaluation method for haptic
// rendering system", eq 1 and 2): what every measuring part i feels, synchronously, with the rates of change.
//
//   M_t = ( F    S     A     a  )      force, displacement, angle, acceleration
//         ( dF   dS    ddS   dA )      and their rates of change
//
// Displacement and force are scalars along the direction of pressing: force > 0 pushes the probe back, displacement > 0
// is into the object. SI units.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"

namespace touchstone::perception {

// One measuring part as it was recorded: any rate, any jitter. Filled columns have the length of t_s.
struct PressSignal {
  std::string name;         // of the part and where it comes from, for messages
  std::vector<double> t_s;  // strictly increasing
  std::vector<double> force_N;
  std::vector<double> displacement_m;
  std::vector<double> angle_rad;              // empty where not measured
  std::vector<double> acceleration_m_per_s2;  // measured; empty: the second derivative of displacement stands in
  double sideways_N = 0.0;  // root mean square of the force across the direction of pressing: no column holds it
};

struct MeasuringPart {
  std::string name;
  std::vector<double> force_N;
  std::vector<double> displacement_m;
  std::vector<double> angle_rad;  // zeros where not measured
  std::vector<double> acceleration_m_per_s2;
  std::vector<double> force_rate_N_per_s;
  std::vector<double> velocity_m_per_s;
  std::vector<double> displacement_second_rate_m_per_s2;
  std::vector<double> angle_rate_rad_per_s;
};

struct HapticDataMatrix {
  double rate_Hz = 0.0;
  std::vector<MeasuringPart> parts;

  [[nodiscard]] std::size_t size() const noexcept { return parts.empty() ? 0 : parts.front().force_N.size(); }
  [[nodiscard]] double t_s(std::size_t t) const noexcept { return static_cast<double>(t) / rate_Hz; }
  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(size()) / rate_Hz; }
  // M_t of eq 2 for part i, laid out as in the header of this file.
  [[nodiscard]] Eigen::Matrix<double, 2, 4> observation(std::size_t t, std::size_t part) const;
};

struct HapticDataMatrixOptions {
  // Else acceleration and the second rate of displacement are left empty: no feature needs them.
  bool second_rates = true;
  double rate_Hz = 0.0;           // of the matrix; 0: the median rate of the first part
  int derivative_half_width = 1;  // samples either side in the least-squares slope; 1 is the central difference
  double longest_gap = 20.0;      // in median sampling intervals: a longer hole is refused rather than bridged
};

// Resamples the parts (linear interpolation) on one uniform grid over the time that all of them share and derives the
// rates. Throws BadData for no part, columns of unequal length, values that are not finite, time that does not advance,
// a hole in the recording, or fewer than four common samples.
HapticDataMatrix make_haptic_data_matrix(std::span<const PressSignal> parts,
                                         const HapticDataMatrixOptions& options = {});

// The outward direction of pressing: that of the summed force. Throws BadData where the force has no direction.
Vec3 press_direction(const recording::Recording& recording);
// The scalars along the outward unit direction. Displacement counts from where the force along it first exceeds
// `contact_force_N` (the start of the recording where it never does); the angle is that of the wrist from its first
// pose.
PressSignal press_signal(const recording::Recording& recording, const Vec3& outward, double contact_force_N);

// Slope by least squares over 2 m + 1 samples (Savitzky and Golay 1964, first degree), one-sided at the ends.
std::vector<double> derivative(std::span<const double> x, double rate_Hz, int half_width);

}  // namespace touchstone::perception
