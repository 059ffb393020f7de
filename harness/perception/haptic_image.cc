#include "harness/perception/haptic_image.h"

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/perception/features/change_rate.h"
#include "harness/perception/filters/sensor_dead_zone.h"

namespace touchstone::perception {

std::vector<double> averaged(std::span<const double> series, std::size_t points) {
  std::vector<double> result(points, 0.0);
  if (series.empty() || points == 0) return result;
  if (series.size() == points) return {series.begin(), series.end()};
  if (series.size() < points) {
    for (std::size_t i = 0; i < points; ++i) {
      const double at = points == 1 ? 0.0
                                    : static_cast<double>(i) * static_cast<double>(series.size() - 1) /
                                          static_cast<double>(points - 1);
      const auto left = std::min(static_cast<std::size_t>(at), series.size() - 1);
      const auto right = std::min(left + 1, series.size() - 1);
      result[i] = series[left] + (at - static_cast<double>(left)) * (series[right] - series[left]);
    }
    return result;
  }
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t first = i * series.size() / points;
    const std::size_t end = (i + 1) * series.size() / points;
    for (std::size_t n = first; n < end; ++n) result[i] += series[n];
    result[i] /= static_cast<double>(end - first);
  }
  return result;
}

namespace {

// Amplitudes gathered into at most `points` bands; a band holds the root of its energy.
std::vector<double> gathered(const std::vector<double>& amplitude, std::size_t points) {
  if (amplitude.size() <= points) return amplitude;
  std::vector<double> result(points, 0.0);
  for (std::size_t k = 0; k < amplitude.size(); ++k) {
    result[k * points / amplitude.size()] += amplitude[k] * amplitude[k];
  }
  for (double& value : result) value = std::sqrt(value);
  return result;
}

}  // namespace

HapticImage haptic_image(const HapticDataMatrix& matrix, const HapticImageOptions& options) {
  HapticImage image;
  for (const auto& part : matrix.parts) {
    const bool first = &part == &matrix.parts.front();
    const std::string prefix = matrix.parts.size() == 1 ? "" : part.name + " ";
    auto force =
        options.sensor_dead_zone_N > 0.0 ? sensor_dead_zone(part.force_N, options.sensor_dead_zone_N) : part.force_N;
    auto displacement = part.displacement_m;
    const auto banded = [&](const std::vector<double>& x) {
      return options.output_band_Hz > 0.0 ? output_band(x, matrix.rate_Hz, options.output_band_Hz) : x;
    };
    const auto band_force = banded(force);
    const auto band_displacement = banded(displacement);
    auto felt_force = dead_band(band_force, options.force_law);
    auto felt_displacement =
        displacement_dead_band(band_displacement, band_force, options.force_law, options.displacement_threshold_m);
    if (options.use_force_rate) {
      image.blocks.push_back({prefix + "force rate", "N/s",
                              averaged(change_rate(felt_force, matrix.rate_Hz), options.points_per_feature)});
    }
    if (options.use_displacement_rate) {
      image.blocks.push_back({prefix + "displacement rate", "m/s",
                              averaged(change_rate(felt_displacement, matrix.rate_Hz), options.points_per_feature)});
    }
    const auto hardness = options.rate_hardness_in_band
                              ? rate_hardness(band_force, band_displacement, options.rate_hardness_window)
                              : rate_hardness(force, displacement, options.rate_hardness_window);
    if (options.use_rate_hardness) {
      image.blocks.push_back(
          {prefix + "rate-hardness", "N/m", averaged(hardness.values_N_per_m, options.points_per_feature)});
    }
    const auto spectrum = amplitude_spectrum(force, matrix.rate_Hz, options.spectrum_limit_Hz);
    if (options.use_spectrum) {
      FeatureBlock block{prefix + "spectrum", "N", gathered(spectrum.amplitude, options.points_per_feature)};
      block.step_Hz = spectrum.step_Hz * static_cast<double>(spectrum.amplitude.size()) /
                      static_cast<double>(std::max<std::size_t>(1, block.values.size()));
      image.blocks.push_back(std::move(block));
    }
    if (first) {
      image.guarded_share = hardness.guarded_share;
      image.harmonic_share = harmonic_share(spectrum);
      image.extended_rate_hardness_N_per_m = extended_rate_hardness(
          part.force_N, part.force_rate_N_per_s, part.velocity_m_per_s, options.force_law.absolute_threshold);
      image.felt_force = std::move(felt_force);
      image.felt_displacement = std::move(felt_displacement);
    }
  }
  if (image.blocks.empty()) throw UsageError("a haptic image needs at least one feature; all four are switched off");
  return image;
}

}  // namespace touchstone::perception
