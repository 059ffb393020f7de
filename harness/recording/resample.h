// Values at other times than those they were sampled at. The method is always chosen and stated; nothing is made up
// across a gap of the clock or outside the recorded span: such values are marked, or refused.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::recording {

// For a sine of frequency f sampled steadily at rate r, x = f / r < 0.5, amplitude 1:
enum class Interpolation : std::uint8_t {
  zero_order_hold,   // the last sample at or before the time. Error up to 2 sin(pi x): a delay of half an interval
  linear,            // error up to 1 - cos(pi x), about (pi x)^2 / 2: 5 % at x = 0.1, 1.1 % at x = 0.047
  cubic,             // through the 4 nearest samples (Lagrange): error up to (3/128) (2 pi x)^4: 0.4 % at x = 0.1.
                     // Exact for cubics on any spacing; beside gaps and ends the stencil moves inward
  windowed_average,  // for going down to a lower rate R: local linear regression (Cleveland 1979) under a Hann window
                     // of width 2/R. No delay; exact for straight lines, beside gaps and ends too. Gain
                     // sinc(2f/R) / (1 - (2f/R)^2): 1/2 at R/2, 0 at R, below 0.027 (-31 dB) beyond: what would alias
                     // is taken out
};
std::string name_of(Interpolation method);

struct ResampleOptions {
  Interpolation method = Interpolation::linear;
  double longest_gap_s = 0.0;   // > 0: longer intervals between samples are not bridged
  double target_rate_Hz = 0.0;  // windowed_average only: R
  bool refuse = false;          // throw BadData for the first value that cannot be had, instead of marking it
};

template <class T>
struct Resampled {
  std::vector<T> values;             // NaN (a rotation: of zeros) where not valid
  std::vector<unsigned char> valid;  // 0 where the time lies in a gap or outside the recorded span
};

// `t_s` and `target_s` strictly increasing, `values` one per t_s, at least two. Throws std::invalid_argument otherwise.
Resampled<Vec3> resample(const std::vector<double>& t_s, const std::vector<Vec3>& values,
                         const std::vector<double>& target_s, const ResampleOptions& options);
Resampled<double> resample(const std::vector<double>& t_s, const std::vector<double>& values,
                           const std::vector<double>& target_s, const ResampleOptions& options);
// Orientation: spherical linear interpolation (Shoemake 1985) the shorter way round; zero_order_hold holds. The method
// is slerp for all others.
Resampled<Quat> resample(const std::vector<double>& t_s, const std::vector<Quat>& values,
                         const std::vector<double>& target_s, const ResampleOptions& options);

// start, start + 1/rate, ... up to and including `end_s` where it falls on the grid. Each is start + i/rate, so that
// rounding does not add up.
std::vector<double> uniform_times(double start_s, double end_s, double rate_Hz);

}  // namespace touchstone::recording
