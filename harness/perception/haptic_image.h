// The haptic image Im_k = (F_i, S_j, R_m, f_n) of one condition (eq 16): force rate, displacement rate, rate-hardness
// and spectrum of its presses, after the perceptual filters (eq 3, 12). Every stage can be set or left out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/perception/features/rate_hardness.h"
#include "harness/perception/features/spectrum.h"
#include "harness/perception/filters/dead_band.h"
#include "harness/perception/filters/output_band.h"
#include "harness/perception/haptic_data_matrix.h"

namespace touchstone::perception {

struct HapticImageOptions {
  WeberLaw force_law = fingertip_force;
  double displacement_threshold_m = 0.0;        // the paper gives none
  double sensor_dead_zone_N = 0.0;              // 0.6 N for the paper's pressure sensor; 0: none
  double output_band_Hz = finger_band_high_Hz;  // 0: no band
  std::size_t rate_hardness_window = default_rate_hardness_window;
  // Rate-hardness is "a local characteristic on a small scale": of the series as measured, or after the output band.
  bool rate_hardness_in_band = false;
  double spectrum_limit_Hz = 25.0;
  std::size_t points_per_feature = 256;  // longer features are averaged down to this many points over time
  bool use_force_rate = true;            // which of the four features enter the image
  bool use_displacement_rate = true;
  bool use_rate_hardness = true;
  bool use_spectrum = true;
};

struct FeatureBlock {
  std::string name;
  std::string unit;
  std::vector<double> values;
  double step_Hz = 0.0;  // of a spectrum, from value to value; 0 for a series over the recording's time
};

struct HapticImage {
  std::vector<FeatureBlock> blocks;
  SparseSeries felt_force;  // after band and dead band, of the first part
  SparseSeries felt_displacement;
  double guarded_share = 0.0;  // of rate-hardness
  double harmonic_share = 0.0;
  std::optional<double> extended_rate_hardness_N_per_m;
};

// Throws BadData where the recording is too short for the window; UsageError for options without a feature.
HapticImage haptic_image(const HapticDataMatrix& matrix, const HapticImageOptions& options);

// Means over `points` equal parts of the series; a shorter series is interpolated linearly.
std::vector<double> averaged(std::span<const double> series, std::size_t points);

}  // namespace touchstone::perception
