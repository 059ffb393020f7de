#include "texture_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "harness/report/gnuplot.h"
#include "harness/stats/distributions.h"

namespace touchstone::texture {
using perception::BandPower;
using perception::FastForce;
using perception::Thresholds;

namespace {

constexpr std::size_t fewest_windows = 8;      // one second with half of each shared
constexpr double decibel = 4.342944819032518;  // 10 / ln 10

using Cell = std::pair<long, long>;
using Cells = std::map<Cell, std::vector<std::size_t>>;

// As perceive's (harness/perception/judge/like_windows.cc).
Cells cells_of(const BandPower& power) {
  constexpr double slides_m_per_s = 0.005;
  Cells cells;
  for (std::size_t w = 0; w < power.segments; ++w) {
    cells[{std::lround(3.0 * std::log2(power.slide_m_per_s[w] / slides_m_per_s)),
           std::lround(2.0 * std::log2(power.load_N[w]))}]
        .push_back(w);
  }
  return cells;
}

struct WeightedMean {
  double mean = 0.0;
  double variance = 0.0;
  double degrees_share = 0.0;  // sum of variances^2 over their degrees of freedom (Satterthwaite 1946)
};

// Adds a cell's mean with a weight.
void add_cell(WeightedMean& sum, const BandPower& power, const std::vector<std::size_t>& windows, std::size_t band,
              double weight) {
  const auto n = static_cast<double>(windows.size());
  double mean = 0.0;
  for (const std::size_t w : windows) mean += power.windows_N2[w][band] / n;
  sum.mean += weight * mean;
  // Means of a model have no spread of their own.
  if (power.gaussian_share[band] == 0.0) return;
  double spread = 0.0;
  for (const std::size_t w : windows) spread += std::pow(power.windows_N2[w][band] - mean, 2);
  const double gaussian = power.gaussian_share[band] * static_cast<double>(power.segments) / n * mean * mean;
  const double variance = weight * weight * (n > 1.0 ? std::max(gaussian, spread / (n * (n - 1.0))) : gaussian);
  sum.variance += variance;
  sum.degrees_share += variance * variance / std::max(1.0, n - 1.0);
}

ComparedBand compare_band(const FastForce& expected, const FastForce& recorded, const Cells& expected_cells,
                          const Cells& recorded_cells, std::size_t band, const Thresholds& thresholds) {
  WeightedMean of_expected, of_recorded;
  for (const auto& [cell, windows] : recorded_cells) {
    const auto like = expected_cells.find(cell);
    if (like == expected_cells.end()) continue;
    const auto weight = static_cast<double>(windows.size());
    add_cell(of_recorded, recorded.contact, windows, band, weight);
    add_cell(of_expected, expected.contact, like->second, band, weight);
  }
  double weights = 0.0;
  for (const auto& [cell, windows] : recorded_cells)
    if (expected_cells.contains(cell)) weights += static_cast<double>(windows.size());
  ComparedBand result;
  result.centre_Hz = perception::band_centres_Hz()[band];
  result.expected_N = std::sqrt(of_expected.mean / weights);
  result.recorded_N = std::sqrt(of_recorded.mean / weights);
  result.threshold_N = thresholds.vibration_force_N(result.centre_Hz) / std::sqrt(2.0);
  result.felt = std::max(result.expected_N, result.recorded_N) >= result.threshold_N;
  result.difference_dB = decibel * std::log(of_recorded.mean / of_expected.mean);
  const double a = of_expected.variance / (of_expected.mean * of_expected.mean);
  const double b = of_recorded.variance / (of_recorded.mean * of_recorded.mean);
  const double shares = of_expected.degrees_share / std::pow(of_expected.mean, 4) +
                        of_recorded.degrees_share / std::pow(of_recorded.mean, 4);
  const double degrees = shares > 0.0 ? std::max(1.0, (a + b) * (a + b) / shares) : 1.0;
  result.interval_dB = decibel * stats::student_t_975(degrees) * std::sqrt(a + b);
  return result;
}

// The verdict by band and its reason; `same` only if every band that is felt is within the tolerance.
void judge_bands(TextureComparison& comparison) {
  const ComparedBand* worst = nullptr;  // certainly outside
  const ComparedBand* undecided = nullptr;
  for (const ComparedBand& band : comparison.bands) {
    if (!band.felt) continue;
    const double off = std::abs(band.difference_dB);
    const bool outside = off - band.interval_dB > comparison.tolerance_dB;
    const bool inside = off + band.interval_dB <= comparison.tolerance_dB;
    if (outside && (worst == nullptr || off > std::abs(worst->difference_dB))) worst = &band;
    if (!inside && (undecided == nullptr || off > std::abs(undecided->difference_dB))) undecided = &band;
  }
  const ComparedBand* const named = worst != nullptr ? worst : undecided;
  comparison.verdict = worst != nullptr       ? TextureVerdict::different
                       : undecided != nullptr ? TextureVerdict::cannot_tell
                                              : TextureVerdict::same;
  if (named == nullptr) {
    comparison.reason = fmt::format("every band that is felt is within {:g} dB", comparison.tolerance_dB);
  } else {
    comparison.reason = fmt::format(
        "near {:.3g} Hz the vibration is {:.3g} mN instead of {:.3g} mN: {:+.2g} +- {:.2g} dB, "
        "and {:g} dB are allowed",
        named->centre_Hz, 1e3 * named->recorded_N, 1e3 * named->expected_N, named->difference_dB, named->interval_dB,
        comparison.tolerance_dB);
    if (worst == nullptr) comparison.reason += "; a longer recording tells";
  }
}

const char* name_of(TextureVerdict verdict) {
  switch (verdict) {
    case TextureVerdict::same:
      return "same";
    case TextureVerdict::different:
      return "different";
    case TextureVerdict::cannot_tell:
      break;
  }
  return "cannot-tell";
}

}  // namespace

TextureComparison compare_textures(const FastForce& expected, const FastForce& recorded, double tolerance_dB,
                                   const Thresholds& thresholds) {
  TextureComparison comparison;
  comparison.tolerance_dB = tolerance_dB;
  comparison.all_windows = recorded.contact.segments;
  const Cells expected_cells = cells_of(expected.contact);
  const Cells recorded_cells = cells_of(recorded.contact);
  for (const auto& [cell, windows] : recorded_cells)
    if (expected_cells.contains(cell)) comparison.windows += windows.size();
  if (comparison.windows < fewest_windows) {
    comparison.reason = fmt::format(
        "both slid at a like speed and force in {} of {} windows of {:.3g} s, and {} are needed; slide as in the other "
        "recording, or longer",
        comparison.windows, comparison.all_windows, recorded.contact.segment_s, fewest_windows);
    return comparison;
  }
  const double highest_Hz = std::min(expected.nyquist_Hz, recorded.nyquist_Hz);
  const double lowest_Hz = std::max(19.0, 1.5 / recorded.contact.segment_s);
  const auto& centres = perception::band_centres_Hz();
  for (std::size_t band = 0; band < centres.size(); ++band) {
    if (centres[band] < lowest_Hz || centres[band] * perception::half_band_ratio > highest_Hz) continue;
    comparison.bands.push_back(compare_band(expected, recorded, expected_cells, recorded_cells, band, thresholds));
  }
  judge_bands(comparison);
  comparison.noticed = perception::vibration_difference(expected, recorded, 0.0, thresholds);
  const perception::VibrationDifference& noticed = comparison.noticed;
  if (noticed.jnd >= 1.0) {
    comparison.verdict = TextureVerdict::different;
    comparison.reason = fmt::format(
        "a person would notice it, with d' = {:.2g}: most near {:.3g} Hz, {:.3g} mN instead "
        "of {:.3g} mN",
        noticed.jnd, noticed.frequency_Hz, 1e3 * noticed.rendered_N, 1e3 * noticed.real_N);
  } else if (comparison.verdict == TextureVerdict::same && !(noticed.known && noticed.measured_jnd < 1.0)) {
    comparison.verdict = TextureVerdict::cannot_tell;
    comparison.reason = fmt::format(
        "whether a person would notice cannot be told: d' = {:.2g} is within what noise "
        "reaches; a longer recording tells",
        noticed.measured_jnd);
  }
  return comparison;
}

std::string text_of(const TextureComparison& comparison) {
  std::string text = fmt::format("{:>8} {:>12} {:>12} {:>12} {:>16}\n", "Hz", "expected, mN", "recorded, mN",
                                 "felt from, mN", "difference, dB");
  for (const ComparedBand& band : comparison.bands) {
    text +=
        fmt::format("{:8.4g} {:12.4g} {:12.4g} {:13.3g} {:>16}\n", band.centre_Hz, 1e3 * band.expected_N,
                    1e3 * band.recorded_N, 1e3 * band.threshold_N,
                    band.felt ? fmt::format("{:+.2f} +- {:.2f}", band.difference_dB, band.interval_dB) : "not felt");
  }
  return text + fmt::format("d' = {:.2g}; {} of {} windows at a like speed and force\n{}: {}\n", comparison.noticed.jnd,
                            comparison.windows, comparison.all_windows, name_of(comparison.verdict), comparison.reason);
}

std::string json_of(const TextureComparison& comparison, const std::string& expected, const std::string& recorded) {
  nlohmann::ordered_json j{{"schema", "touchstone-texture-comparison/1"},
                           {"expected", expected},
                           {"recorded", recorded},
                           {"verdict", name_of(comparison.verdict)},
                           {"reason", comparison.reason},
                           {"tolerance_dB", comparison.tolerance_dB},
                           {"windows", comparison.windows},
                           {"all_windows", comparison.all_windows},
                           {"d_prime", comparison.noticed.jnd},
                           {"d_prime_measured", comparison.noticed.measured_jnd},
                           {"d_prime_standard_error", comparison.noticed.standard_error}};
  j["bands"] = nlohmann::ordered_json::array();
  for (const ComparedBand& band : comparison.bands) {
    j["bands"].push_back({{"centre_Hz", band.centre_Hz},
                          {"expected_N", band.expected_N},
                          {"recorded_N", band.recorded_N},
                          {"threshold_N", band.threshold_N},
                          {"felt", band.felt},
                          {"difference_dB", band.difference_dB},
                          {"interval_dB", band.interval_dB}});
  }
  return j.dump(1) + "\n";
}

std::string write_picture(const TextureComparison& comparison, const std::string& png) {
  report::PlotLine expected{"expected", {}, false}, recorded{"recorded", {}, true}, threshold{"felt from", {}, false};
  for (const ComparedBand& band : comparison.bands) {
    const double octaves = std::log2(band.centre_Hz / 20.0);
    const auto level = [](double force_N) { return 2.0 * decibel * std::log(std::max(force_N, 1e-9) / 1e-3); };
    expected.points.emplace_back(octaves, level(band.expected_N));
    recorded.points.emplace_back(octaves, level(band.recorded_N));
    threshold.points.emplace_back(octaves, level(band.threshold_N));
  }
  return report::write_plot({"Fast force in third-octave bands: " + std::string(name_of(comparison.verdict)),
                             "octaves above 20 Hz: 1 is 40 Hz, 3 is 160 Hz",
                             {{"", "dB above 1 mN", {expected, recorded, threshold}}}},
                            png);
}

}  // namespace touchstone::texture
