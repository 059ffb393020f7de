#include "harness/perception/judge/vibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "harness/perception/fourier.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {
namespace {

constexpr double kOnset_s = 0.064;
constexpr double kAirBefore_s = 0.02;
constexpr double kAirMargin_s = 0.024;  // around contact: longer than the smoothing of positions
constexpr std::array<double, 3> kSegments_s{0.256, 0.128, 0.064};
constexpr std::size_t kWantedSegments = 4;
constexpr std::size_t kWantedAir = 4;
constexpr std::size_t kFewestOnsets = 3;

// Third-octave band from c / 2^(1/6) to c 2^(1/6).
const double kHalfBand = std::exp2(1.0 / 6.0);

enum class Phase : unsigned char { air, contact };

struct FastParts {
  std::array<std::vector<double>, 3> residual_N;
  std::vector<Phase> phase;
};

class PowerSum {
 public:
  // `taper`: Hann; else the samples as they are. The mean is taken out.
  PowerSum(double rate_Hz, std::size_t length, bool taper)
      : rate_Hz_(rate_Hz), length_(length), window_(length, 1.0), sum_(band_centres_Hz().size(), 0.0), squares_(sum_) {
    double energy = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      if (taper) {
        window_[i] =
            0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
      }
      energy += window_[i] * window_[i];
    }
    // Parseval: the mean square is the sum over the bins of |X|^2 (twice, for the negative frequencies) over N energy.
    scale_ = 2.0 / (energy * static_cast<double>(length));
  }

  void add(const std::array<std::vector<double>, 3>& x, std::size_t first) {
    std::vector<double> bands(sum_.size(), 0.0);
    std::vector<double> segment(length_);
    for (const auto& axis : x) {
      double mean = 0.0;
      for (std::size_t i = 0; i < length_; ++i) mean += axis[first + i];
      mean /= static_cast<double>(length_);
      for (std::size_t i = 0; i < length_; ++i) segment[i] = window_[i] * (axis[first + i] - mean);
      const auto spectrum = real_fourier(segment);
      for (std::size_t k = 1; 2 * k < length_; ++k) {
        const double f = static_cast<double>(k) * rate_Hz_ / static_cast<double>(length_);
        const int band = band_of(f);
        if (band >= 0) bands[static_cast<std::size_t>(band)] += scale_ * std::norm(spectrum[k]);
      }
    }
    for (std::size_t b = 0; b < bands.size(); ++b) {
      sum_[b] += bands[b];
      squares_[b] += bands[b] * bands[b];
    }
    ++count_;
  }

  [[nodiscard]] BandPower result() const {
    BandPower power;
    power.segments = count_;
    power.segment_s = static_cast<double>(length_) / rate_Hz_;
    if (count_ == 0) return power;
    const auto n = static_cast<double>(count_);
    for (std::size_t b = 0; b < sum_.size(); ++b) {
      const double mean = sum_[b] / n;
      power.power_N2.push_back(mean);
      const double spread = n > 1.0 ? std::max(0.0, (squares_[b] - n * mean * mean) / (n - 1.0)) : mean * mean;
      power.variance_N4.push_back(spread / n);
    }
    return power;
  }

 private:
  [[nodiscard]] static int band_of(double f_Hz) {
    const auto& centres = band_centres_Hz();
    if (f_Hz < centres.front() / kHalfBand || f_Hz >= centres.back() * kHalfBand) return -1;
    const auto band = static_cast<int>(std::lround(3.0 * std::log2(f_Hz / centres.front())));
    return std::clamp(band, 0, static_cast<int>(centres.size()) - 1);
  }

  double rate_Hz_;
  std::size_t length_;
  std::vector<double> window_;
  std::vector<double> sum_;
  std::vector<double> squares_;
  double scale_ = 0.0;
  std::size_t count_ = 0;
};

FastParts fast_parts(const FeltSeries& felt, const Response& response) {
  FastParts parts;
  for (auto& axis : parts.residual_N) axis.resize(felt.size());
  parts.phase.resize(felt.size());
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const double d = felt.depth_m[i] - response.contact_m;
    // The band around first contact is neither: a kink is no vibration.
    parts.phase[i] = d >= 0.0 ? Phase::contact : Phase::air;
    const auto expected = expected_force_N(response, felt, response.contact_m, i);
    for (std::size_t a = 0; a < 3; ++a) parts.residual_N[a][i] = felt.force_N[a][i] - expected[a];
  }
  return parts;
}

// Runs of samples of one phase, [first, end), without `margin` samples at both ends.
std::vector<std::pair<std::size_t, std::size_t>> runs(const std::vector<Phase>& phase, Phase wanted,
                                                      std::size_t margin) {
  std::vector<std::pair<std::size_t, std::size_t>> result;
  std::size_t i = 0;
  while (i < phase.size()) {
    if (phase[i] != wanted) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < phase.size() && phase[end] == wanted) ++end;
    const std::size_t first = i == 0 ? 0 : i + margin;
    const std::size_t last = end == phase.size() ? end : end - std::min(end, margin);
    if (first < last) result.emplace_back(first, last);
    i = end;
  }
  return result;
}

// Windows of one length without taper, one after the other.
BandPower window_power(const FastParts& parts, Phase phase, double rate_Hz, std::size_t margin, std::size_t length) {
  PowerSum sum(rate_Hz, length, false);
  for (const auto& [first, end] : runs(parts.phase, phase, margin)) {
    for (std::size_t at = first; at + length <= end; at += length) sum.add(parts.residual_N, at);
  }
  return sum.result();
}

BandPower steady_power(const FastParts& parts, Phase phase, double rate_Hz, std::size_t margin) {
  const auto stretches = runs(parts.phase, phase, margin);
  for (const double segment_s : kSegments_s) {
    const auto length = static_cast<std::size_t>(std::round(segment_s * rate_Hz));
    if (length < 4) continue;
    std::size_t available = 0;
    for (const auto& [first, end] : stretches) {
      if (end - first >= length) available += 1 + (end - first - length) / std::max<std::size_t>(1, length / 2);
    }
    if (available < kWantedSegments && segment_s != kSegments_s.back()) continue;
    PowerSum sum(rate_Hz, length, true);
    for (const auto& [first, end] : stretches) {
      for (std::size_t at = first; at + length <= end; at += std::max<std::size_t>(1, length / 2)) {
        sum.add(parts.residual_N, at);
      }
    }
    return sum.result();
  }
  return {};
}

// Each band's difference of amplitudes in units of its threshold.
VibrationDifference difference(const std::vector<double>& real_N2, const std::vector<double>& rendered_N2,
                               const std::vector<double>& variance_N4, double threshold_factor, double lowest_Hz,
                               double highest_Hz, const Thresholds& thresholds) {
  VibrationDifference result;
  result.known = true;
  const auto& centres = band_centres_Hz();
  double masker = 0.0;
  double squared = 0.0;
  double variance = 0.0;
  double most = -1.0;
  for (std::size_t b = 0; b < centres.size(); ++b) {
    if (centres[b] < lowest_Hz || centres[b] * kHalfBand > highest_Hz) continue;
    const double t2 = std::pow(threshold_factor * thresholds.vibration_force_N(centres[b]), 2) / 2.0;
    const double real = std::max(0.0, real_N2[b]) / t2;
    const double rendered = std::max(0.0, rendered_N2[b]) / t2;
    masker += real;
    const double amplitude = std::sqrt(rendered) - std::sqrt(real);
    const double larger = std::max(real, rendered);
    const double error = std::sqrt(variance_N4[b]) / t2;  // of the difference of powers
    // The expectation of the squared difference of amplitudes of equal powers known to `error`.
    const double excess = error > 0.0 ? error * error / (error + 4.0 * larger) : 0.0;
    squared += amplitude * amplitude - excess;
    // Error of an amplitude near sqrt(power): d sqrt(P) = dP / (2 sqrt(P)); near none, sqrt(dP).
    const double of_amplitude = error / std::sqrt(error + 4.0 * larger + 1e-300);
    // Of the squared difference: 2 D dD, and the square of dD itself where D is nothing.
    variance += 4.0 * amplitude * amplitude * of_amplitude * of_amplitude + std::pow(of_amplitude, 4);
    if (std::abs(amplitude) > most) {
      most = std::abs(amplitude);
      result.frequency_Hz = centres[b];
      result.real_N = std::sqrt(std::max(0.0, real_N2[b]));
      result.rendered_N = std::sqrt(std::max(0.0, rendered_N2[b]));
      result.threshold_N = std::sqrt(t2);
    }
  }
  const double mask = 1.0 + thresholds.vibration_fraction * thresholds.vibration_fraction * masker;
  result.jnd2 = squared / mask;
  result.jnd2_error = std::sqrt(variance) / mask;
  return result;
}

}  // namespace

const std::vector<double>& band_centres_Hz() {
  static const std::vector<double> centres = [] {
    std::vector<double> result;
    for (int b = 0; b < 18; ++b) result.push_back(20.0 * std::exp2(b / 3.0));
    return result;
  }();
  return centres;
}

FastForce fast_force(const FeltSeries& felt, const Response& response) {
  FastForce fast;
  fast.nyquist_Hz = 0.5 * felt.rate_Hz;
  const FastParts parts = fast_parts(felt, response);
  const auto onset_length = static_cast<std::size_t>(std::round(kOnset_s * felt.rate_Hz));
  fast.contact = steady_power(parts, Phase::contact, felt.rate_Hz, onset_length);
  const auto air_margin = static_cast<std::size_t>(std::round(kAirMargin_s * felt.rate_Hz));
  fast.air = steady_power(parts, Phase::air, felt.rate_Hz, air_margin);

  const auto before = static_cast<std::size_t>(std::max(1.0, std::round(kAirBefore_s * felt.rate_Hz)));
  if (onset_length < 8) return fast;
  fast.between = window_power(parts, Phase::contact, felt.rate_Hz, onset_length, onset_length);
  PowerSum sum(felt.rate_Hz, onset_length, false);
  std::vector<double> speeds;
  std::size_t air = 0;
  for (std::size_t i = 0; i + onset_length <= felt.size(); ++i) {
    if (parts.phase[i] == Phase::air) {
      ++air;
      continue;
    }
    if (air >= before && felt.rate_of_depth_m_per_s[i] > 0.0) {
      sum.add(parts.residual_N, i);
      speeds.push_back(felt.rate_of_depth_m_per_s[i]);
    }
    air = 0;
  }
  fast.onset = sum.result();
  fast.onsets = speeds.size();
  if (!speeds.empty()) fast.onset_speed_m_per_s = stats::median(speeds);
  return fast;
}

namespace {

// Power in contact without that of the sensor; `air` may be of another recording by the same sensor.
std::vector<double> without_noise(const FastForce& fast, const BandPower& air, double noise_N2_per_Hz,
                                  std::vector<double>& variance_N4) {
  std::vector<double> power = fast.contact.power_N2;
  for (std::size_t b = 0; b < power.size(); ++b) {
    variance_N4[b] += fast.contact.variance_N4[b];
    if (air.segments > 0) {
      power[b] -= air.power_N2[b];
      variance_N4[b] += air.variance_N4[b];
    } else {
      power[b] -= noise_N2_per_Hz * band_centres_Hz()[b] * (kHalfBand - 1.0 / kHalfBand);
    }
  }
  return power;
}

}  // namespace

VibrationDifference vibration_difference(const FastForce& real, const FastForce& rendered, double noise_N2_per_Hz,
                                         const Thresholds& thresholds) {
  if (real.contact.segments == 0 || rendered.contact.segments == 0) return {};
  std::vector<double> variance_N4(band_centres_Hz().size(), 0.0);
  const bool own_air = real.air.segments >= kWantedAir && rendered.air.segments >= kWantedAir;
  const BandPower& more_air = real.air.segments >= rendered.air.segments ? real.air : rendered.air;
  const auto real_N2 = without_noise(real, own_air ? real.air : more_air, noise_N2_per_Hz, variance_N4);
  const auto rendered_N2 = without_noise(rendered, own_air ? rendered.air : more_air, noise_N2_per_Hz, variance_N4);
  // Below one and a half bins of the shorter segments the taper lets the slow force in.
  const double lowest = 1.5 / std::min(real.contact.segment_s, rendered.contact.segment_s);
  return difference(real_N2, rendered_N2, variance_N4, 1.0, std::max(19.0, lowest),
                    std::min(real.nyquist_Hz, rendered.nyquist_Hz), thresholds);
}

VibrationDifference transient_difference(const FastForce& real, const FastForce& rendered,
                                         const Thresholds& thresholds) {
  if (real.onsets < kFewestOnsets || rendered.onsets < kFewestOnsets) return {};
  const std::size_t bands = band_centres_Hz().size();
  std::vector<double> real_N2 = real.onset.power_N2;
  std::vector<double> rendered_N2 = rendered.onset.power_N2;
  std::vector<double> variance_N4(bands, 0.0);
  const double scale = std::pow(real.onset_speed_m_per_s / rendered.onset_speed_m_per_s, 2);
  const auto less_steady = [&](std::vector<double>& power, const FastForce& fast, double factor) {
    for (std::size_t b = 0; b < bands; ++b) {
      variance_N4[b] += fast.onset.variance_N4[b] * factor * factor;
      if (fast.between.segments > 0) {
        power[b] -= fast.between.power_N2[b];
        variance_N4[b] += fast.between.variance_N4[b] * factor * factor;
      }
      power[b] *= factor;
    }
  };
  less_steady(real_N2, real, 1.0);
  less_steady(rendered_N2, rendered, scale);
  const double factor = std::sqrt(std::max(1.0, thresholds.vibration_integration_s / kOnset_s));
  return difference(real_N2, rendered_N2, variance_N4, factor, 39.0, std::min(real.nyquist_Hz, rendered.nyquist_Hz),
                    thresholds);
}

}  // namespace touchstone::perception
