// For vibration: ST-SIM (Hassen and Steinbach, "Subjective evaluation of the spectral temporal similarity (ST-SIM)
// measure for vibrotactile quality assessment", 2020) and SPQI (Noll, Hofbauer, Muschter, Li and Steinbach, "Automated
// quality assessment for compressed vibrotactile signals using multi-method assessment fusion", 2022). Their source is
// the reference implementation of the latter authors (hofbi/vibromaf, MIT), from which formulae and constants are
// taken.
//
// Blocks of 512 samples; every block's orthonormal cosine transform in dB is put above the threshold of vibration
//   T(f) = | 62 / log10(6/11)^2 * log10(f / 550 Hz + 6/11)^2 | - 77 dB,  held from where it first exceeds 0.
// The threshold presumes signals on the scale of their data set (accelerations of the order of 1, 2800 to 8000 Hz); at
// other scales the value is computed all the same and means less.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace touchstone::perception {

struct VibrationSettings {
  double rate_Hz = 8000.0;
  std::size_t block = 512;
  double stsim_eta = 2.0 / 3.0;  // weight of the temporal part
  double support_dB = 12.0;      // scale of the normal distribution that turns dB above threshold into support
  double spqi_eta = 0.3;
  double spqi_threshold = -2.0;
};

// Threshold in dB at k * rate / (2 block) for k = 0..block-1 (their grid spans the rate in 2 block points, ends
// included).
std::vector<double> vibration_threshold_dB(double rate_Hz, std::size_t block);

// Both are 1 for equal signals. The remainder that fills no block is left out. Throw BadData for signals of unequal
// length or shorter than a block.
double spectral_temporal_similarity(std::span<const double> real, std::span<const double> rendered,
                                    const VibrationSettings& settings);
double spectral_perceptual_quality_index(std::span<const double> real, std::span<const double> rendered,
                                         const VibrationSettings& settings);

}  // namespace touchstone::perception
