#include "harness/perception/distances/vibration_similarity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/perception/fourier.h"
#include "harness/stats/distributions.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

constexpr double machine_epsilon = std::numeric_limits<double>::epsilon();

void check(std::span<const double> real, std::span<const double> rendered, std::size_t block) {
  if (block == 0 || real.size() != rendered.size() || real.size() < block) {
    throw BadData(
        fmt::format("vibrations are compared in blocks of {} samples; two signals of one length and at least that "
                    "are needed, not {} and {} samples",
                    block, real.size(), rendered.size()));
  }
}

// dB above the threshold of one block.
std::vector<double> perceptual_spectrum(std::span<const double> block, const std::vector<double>& threshold_dB) {
  auto spectrum = cosine_transform(block);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] = 20.0 * std::log10(std::abs(spectrum[k])) - threshold_dB[k];
  }
  return spectrum;
}

// Projection of the rendered block on the real one, over the real one's energy.
double similarity(const std::vector<double>& real, const std::vector<double>& rendered) {
  double both = 0.0;
  double own = 0.0;
  for (std::size_t i = 0; i < real.size(); ++i) {
    both += real[i] * rendered[i];
    own += real[i] * real[i];
  }
  return both / (own + machine_epsilon);
}

std::vector<double> normalised(std::span<const double> block) {
  const double centre = stats::mean(block);
  const double spread = stats::standard_deviation(block) + machine_epsilon;
  std::vector<double> result;
  result.reserve(block.size());
  for (const double value : block) result.push_back((value - centre) / spread);
  return result;
}

}  // namespace

std::vector<double> vibration_threshold_dB(double rate_Hz, std::size_t block) {
  const double offset = 1.0 - 250.0 / 550.0;
  const double scale = 62.0 / std::pow(std::log10(offset), 2);
  std::vector<double> threshold(block);
  double ceiling = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < block; ++k) {
    const double f_Hz = static_cast<double>(k) * rate_Hz / (2.0 * static_cast<double>(block) - 1.0);
    const double dB = std::abs(scale * std::pow(std::log10(f_Hz / 550.0 + offset), 2)) - 77.0;
    if (dB > 0.0) ceiling = std::min(ceiling, dB);
    threshold[k] = std::isfinite(ceiling) ? ceiling : dB;
  }
  return threshold;
}

double spectral_temporal_similarity(std::span<const double> real, std::span<const double> rendered,
                                    const VibrationSettings& settings) {
  check(real, rendered, settings.block);
  if (std::equal(real.begin(), real.end(), rendered.begin())) return 1.0;
  const auto threshold = vibration_threshold_dB(settings.rate_Hz, settings.block);
  const auto support = [&](std::span<const double> block) {
    auto spectrum = perceptual_spectrum(block, threshold);
    for (double& value : spectrum) value = stats::normal_cdf(value / settings.support_dB);
    return spectrum;
  };
  double spectral = 0.0;
  double temporal = 0.0;
  const std::size_t blocks = real.size() / settings.block;
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto x = real.subspan(b * settings.block, settings.block);
    const auto y = rendered.subspan(b * settings.block, settings.block);
    spectral += similarity(support(x), support(y)) / static_cast<double>(blocks);
    temporal += similarity(normalised(x), normalised(y)) / static_cast<double>(blocks);
  }
  // A negative temporal likeness (counter-phase) has no real power: nothing is alike.
  return std::pow(std::max(temporal, 0.0), settings.stsim_eta) * std::pow(spectral, 1.0 - settings.stsim_eta);
}

double spectral_perceptual_quality_index(std::span<const double> real, std::span<const double> rendered,
                                         const VibrationSettings& settings) {
  check(real, rendered, settings.block);
  if (std::equal(real.begin(), real.end(), rendered.begin())) return 1.0;
  const auto threshold = vibration_threshold_dB(settings.rate_Hz, settings.block);
  const std::size_t blocks = real.size() / settings.block;
  double sum = 0.0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto x = perceptual_spectrum(real.subspan(b * settings.block, settings.block), threshold);
    const auto y = perceptual_spectrum(rendered.subspan(b * settings.block, settings.block), threshold);
    double difference = 0.0;
    double own = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      difference += std::abs(std::pow(10.0, 0.1 * x[k]) - std::pow(10.0, 0.1 * y[k]));
      own += std::pow(10.0, 0.1 * x[k]);
    }
    const double difference_dB = 10.0 * std::log10(difference / (own + machine_epsilon));
    sum += 0.5 * (1.0 - std::tanh(settings.spqi_eta * difference_dB - settings.spqi_threshold));
  }
  return sum / static_cast<double>(blocks);
}

}  // namespace touchstone::perception
