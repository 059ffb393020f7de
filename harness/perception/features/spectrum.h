// Frequency feature (section 3.3, figure 10): the amplitude spectrum of the force over repeated presses.
#pragma once

#include <span>
#include <vector>

namespace touchstone::perception {

struct Spectrum {
  double step_Hz = 0.0;           // frequency of value k is k * step_Hz
  std::vector<double> amplitude;  // of a sine of that frequency, in the series's unit; the mean is taken out first
};

// Hann window, amplitudes corrected for it, up to limit_Hz (the Nyquist frequency where that is lower).
Spectrum amplitude_spectrum(std::span<const double> x, double rate_Hz, double limit_Hz);

// The harmonic distortion of presses repeated at the frequency of the largest amplitude: root of the energy in its
// multiples (each with its two neighbours, which the window shares) over that of itself. 0 for a series without a peak.
double harmonic_share(const Spectrum& spectrum);

}  // namespace touchstone::perception
