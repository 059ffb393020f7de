// The fr(t) of eq 3: what a fingertip can do in time. Its output band reaches to 2-6 Hz (Brooks 1990, Jones and Hunter
// 1990), so nothing faster than the chosen end of that range is the finger's own. The paper names the band and not the
// filter. Here: the cosine transform (type II) of the series, all coefficients above the band set to zero, and back.
// The cosine transform extends a series by its mirror image, so that its ends need not meet; as a projection it is
// linear and filtering twice changes nothing beyond rounding.
#pragma once

#include <span>
#include <vector>

namespace touchstone::perception {

inline constexpr double finger_band_low_Hz = 2.0;
inline constexpr double finger_band_high_Hz = 6.0;

// Keeps 0..limit_Hz. Throws UsageError unless 0 < limit_Hz and 0 < rate_Hz.
std::vector<double> output_band(std::span<const double> x, double rate_Hz, double limit_Hz = finger_band_high_Hz);

}  // namespace touchstone::perception
