// Lines and bands in the raw residual, from half of the block rate up to Nyquist: what means over blocks cannot show. A
// mean over two samples of a 60 Hz tracker cancels every multiple of 30 Hz, and mains hum with it.
//
// Estimate: averaged periodograms of overlapping segments with a Hann taper (Welch 1967), at several segment lengths,
// since a line stands out most in one long segment and a broad resonance in the mean of many short ones. Background,
// per axis: the larger of a running median of the neighbouring frequencies, and the mean spectrum of simulated
// recordings in which the model is the truth under the declared noise. In Gaussian noise of that spectrum an ordinate
// over its background, summed over axes and segments, has a gamma distribution (chi-squared with two degrees of freedom
// per periodogram: Priestley 1981, section 6.2.2), so that its tail, times the number of ordinates looked at
// (Bonferroni), bounds the probability of a false alarm in one recording.
//
// A peak that the model's own prediction shows as well comes with the motion (a tracker's interpolation, a tool that
// really vibrates) and is no line of the residual.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/discrepancy/structure_detector.h"

namespace touchstone::discrepancy {

enum class ActsWhile : std::uint8_t { always, touching, sliding };

// "always", "in contact", "while sliding".
std::string to_string(ActsWhile acts);

struct SpectralPeak {
  double frequency_Hz = 0.0;       // centroid of what exceeds the background
  double width_Hz = 0.0;           // full width at half of the peak; of a line what the recording's length resolves
  double rms_N = 0.0;              // 3-D, of what exceeds the background
  double log10_false_alarm = 0.0;  // of the bound on the probability that noise shows as strong a peak anywhere
  ActsWhile acts = ActsWhile::always;
  // "mains hum", "buzz while sliding", "resonance" (a band) or "tone" (a line).
  std::string name;
};

struct ResidualSpectrum {
  std::vector<SpectralPeak> peaks;  // strongest first; of two recordings those that both show
  double from_Hz = 0.0;             // half of the block rate
  double to_Hz = 0.0;               // Nyquist
  // RMS of the held-out raw residual between these frequencies, and the most that any simulated recording, or replica
  // of the tracker's noise, shows where the model is the truth.
  double raw_N = 0.0;
  double null_N = 0.0;
  // What the verdict goes by: peaks of more than this share of the held-out raw residual's square (below, a peak is
  // listed alone), and a level far above the noise, twice the amplitude of what any simulated recording shows.
  static constexpr double least_peak_share = 0.02;
  static constexpr double far_above = 2.0;
  double share = 0.0;  // of the held-out raw residual's square, by all peaks
  [[nodiscard]] bool peaks_matter() const;
  [[nodiscard]] bool far_above_noise() const;
};

// Of one recording. `from_Hz`: where to begin. Nothing of recordings that are too short.
std::vector<SpectralPeak> find_peaks(const DetectorSide& side, const rendering::Model& model, double from_Hz);

// `train` and `holdout` may be one recording: then its peaks need no second one. `window_s`: of the blocks.
ResidualSpectrum residual_spectrum(const DetectorSide& train, const DetectorSide& holdout,
                                   const rendering::Model& model, double window_s);

// "mains hum of 60.00 Hz (0.53 N RMS)", one after the other.
std::string describe(const std::vector<SpectralPeak>& peaks);

}  // namespace touchstone::discrepancy
