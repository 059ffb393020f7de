#include "harness/perception/judge/vibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "harness/perception/fourier.h"
#include "harness/perception/judge/replay_path.h"
#include "harness/perception/judge/vibration_scale.h"
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

// Third-octave band that holds the frequency; -1: none.
int band_of(double f_Hz) {
  const auto& centres = band_centres_Hz();
  if (f_Hz < centres.front() / kHalfBand || f_Hz >= centres.back() * kHalfBand) return -1;
  const auto band = static_cast<int>(std::lround(3.0 * std::log2(f_Hz / centres.front())));
  return std::clamp(band, 0, static_cast<int>(centres.size()) - 1);
}

// What a frequency's power counts as at the centre of its band.
double weight_at(double f_Hz, double centre_Hz, const Thresholds& thresholds) {
  return std::pow(thresholds.vibration_force_N(centre_Hz) / thresholds.vibration_force_N(f_Hz), 2);
}

class PowerSum {
 public:
  // `taper`: Hann, and the mean is taken out. Else the samples as they are, and a parabola is taken out: what bends
  // more slowly than the window would leak into every band at its ends.
  PowerSum(double rate_Hz, std::size_t length, bool taper, const Thresholds& thresholds)
      : rate_Hz_(rate_Hz), length_(length), window_(length, 1.0), sum_(band_centres_Hz().size(), 0.0), squares_(sum_) {
    double energy = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      if (taper) {
        window_[i] =
            0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length));
      }
      energy += window_[i] * window_[i];
    }
    if (!taper) add_parabola();
    // Parseval: the mean square is the sum over the bins of |X|^2 (twice, for the negative frequencies) over N energy.
    const double scale = 2.0 / (energy * static_cast<double>(length));
    for (std::size_t k = 0; 2 * k < length; ++k) {
      const double f = static_cast<double>(k) * rate_Hz / static_cast<double>(length);
      const int band = k == 0 ? -1 : band_of(f);
      band_.push_back(band);
      weight_.push_back(band >= 0 ? scale * weight_at(f, band_centres_Hz()[static_cast<std::size_t>(band)], thresholds)
                                  : 0.0);
    }
  }

  void add(const std::array<std::vector<double>, 3>& x, std::size_t first) {
    std::vector<double> bands(sum_.size(), 0.0);
    std::vector<double> segment(length_);
    for (const auto& axis : x) {
      double mean = 0.0;
      for (std::size_t i = 0; i < length_; ++i) mean += axis[first + i];
      mean /= static_cast<double>(length_);
      for (std::size_t i = 0; i < length_; ++i) segment[i] = window_[i] * (axis[first + i] - mean);
      for (const auto& slow : slow_) {
        double along = 0.0;
        for (std::size_t i = 0; i < length_; ++i) along += slow[i] * segment[i];
        for (std::size_t i = 0; i < length_; ++i) segment[i] -= along * slow[i];
      }
      const auto spectrum = real_fourier(segment);
      for (std::size_t k = 1; 2 * k < length_; ++k) {
        if (band_[k] >= 0) bands[static_cast<std::size_t>(band_[k])] += weight_[k] * std::norm(spectrum[k]);
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
  // Line and parabola over the window, orthonormal to one another and to a constant.
  void add_parabola() {
    std::vector<double> line(length_);
    std::vector<double> parabola(length_);
    double line_squares = 0.0;
    for (std::size_t i = 0; i < length_; ++i) {
      line[i] = static_cast<double>(i) - 0.5 * static_cast<double>(length_ - 1);
      line_squares += line[i] * line[i];
    }
    double parabola_squares = 0.0;
    for (std::size_t i = 0; i < length_; ++i) {
      parabola[i] = line[i] * line[i] - line_squares / static_cast<double>(length_);
      parabola_squares += parabola[i] * parabola[i];
    }
    for (double& value : line) value /= std::sqrt(line_squares);
    for (double& value : parabola) value /= std::sqrt(parabola_squares);
    slow_ = {std::move(line), std::move(parabola)};
  }

  double rate_Hz_;
  std::size_t length_;
  std::vector<double> window_;
  std::vector<std::vector<double>> slow_;  // taken out beside the mean
  std::vector<double> sum_;
  std::vector<double> squares_;
  std::vector<int> band_;       // of each frequency of the spectrum
  std::vector<double> weight_;  // of each frequency's power
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
BandPower window_power(const FastParts& parts, Phase phase, double rate_Hz, std::size_t margin, std::size_t length,
                       const Thresholds& thresholds) {
  PowerSum sum(rate_Hz, length, false, thresholds);
  for (const auto& [first, end] : runs(parts.phase, phase, margin)) {
    for (std::size_t at = first; at + length <= end; at += length) sum.add(parts.residual_N, at);
  }
  return sum.result();
}

BandPower steady_power(const FastParts& parts, Phase phase, double rate_Hz, std::size_t margin,
                       const Thresholds& thresholds) {
  const auto stretches = runs(parts.phase, phase, margin);
  for (const double segment_s : kSegments_s) {
    const auto length = static_cast<std::size_t>(std::round(segment_s * rate_Hz));
    if (length < 4) continue;
    std::size_t available = 0;
    for (const auto& [first, end] : stretches) {
      if (end - first >= length) available += 1 + (end - first - length) / std::max<std::size_t>(1, length / 2);
    }
    if (available < kWantedSegments && segment_s != kSegments_s.back()) continue;
    PowerSum sum(rate_Hz, length, true, thresholds);
    for (const auto& [first, end] : stretches) {
      for (std::size_t at = first; at + length <= end; at += std::max<std::size_t>(1, length / 2)) {
        sum.add(parts.residual_N, at);
      }
    }
    return sum.result();
  }
  return {};
}

// d'^2 of one cue: a sum of squares whose terms are known with an error.
struct SquaredEvidence {
  double square = 0.0;    // what noise adds on average taken off; may be below 0
  double exceeds = 0.0;   // what exceeds all that noise alone reaches in 95 %; may be below 0
  double variance = 0.0;  // of the root
};

// What is compared, by band.
struct ComparedPower {
  std::vector<double> real_N2;
  std::vector<double> rendered_N2;
  std::vector<double> variance_N4;  // of their difference
  std::vector<double> masker_N2;    // felt beside either; empty: nothing
};

VibrationDifference difference(const ComparedPower& power, double threshold_factor, double lowest_Hz, double highest_Hz,
                               const Thresholds& thresholds) {
  VibrationDifference result;
  result.known = true;
  const auto& centres = band_centres_Hz();
  double real_sum = 0.0;  // power over that of the threshold
  double rendered_sum = 0.0;
  double masker_sum = 0.0;
  double variance_sum = 0.0;
  double squares = 0.0;  // of the bands' differences
  double variance_of_squares = 0.0;
  double variance_along = 0.0;
  double most = -1.0;
  double real_most = 0.0;
  for (std::size_t b = 0; b < centres.size(); ++b) {
    if (centres[b] < lowest_Hz || centres[b] * kHalfBand > highest_Hz) continue;
    const double t2 = std::pow(threshold_factor * thresholds.vibration_force_N(centres[b]), 2) / 2.0;
    const double real = power.real_N2[b] / t2;
    const double rendered = power.rendered_N2[b] / t2;
    const double variance = power.variance_N4[b] / (t2 * t2);
    if (!power.masker_N2.empty()) masker_sum += power.masker_N2[b] / t2;
    const double apart = rendered - real;
    real_sum += real;
    rendered_sum += rendered;
    variance_sum += variance;
    squares += apart * apart;
    variance_of_squares += 2.0 * variance * variance;
    variance_along += apart * apart * variance;
    if (std::abs(apart) > most) {
      most = std::abs(apart);
      real_most = std::max(0.0, real);
      result.frequency_Hz = centres[b];
      result.real_N = std::sqrt(std::max(0.0, power.real_N2[b]));
      result.rendered_N = std::sqrt(std::max(0.0, power.rendered_N2[b]));
      result.threshold_N = std::sqrt(t2);
    }
  }
  constexpr double kNoise95 = 1.959964;
  const double apart = rendered_sum - real_sum;
  const SquaredEvidence strength{apart * apart, apart * apart - kNoise95 * kNoise95 * variance_sum, variance_sum};
  const SquaredEvidence profile{squares - variance_sum,
                                squares - variance_sum - kNoise95 * std::sqrt(variance_of_squares),
                                squares > 0.0 ? variance_along / squares : variance_sum};
  const SquaredEvidence& better = strength.exceeds >= profile.exceeds ? strength : profile;
  const VibrationScale scale(thresholds);
  const double beside = std::max(0.0, masker_sum);
  const double observer = scale.noise_between(std::max(0.0, real_sum) + beside, std::max(0.0, rendered_sum) + beside);
  result.jnd = std::sqrt(std::max(0.0, better.exceeds)) / observer;
  result.measured_jnd = std::sqrt(std::max(0.0, better.square)) / observer;
  result.standard_error = std::sqrt(better.variance) / observer;
  result.allowed_N = result.threshold_N * (std::sqrt(real_most + scale.noticed_from(std::max(0.0, real_sum) + beside)) -
                                           std::sqrt(real_most));
  return result;
}

// Mean square of the response's slope over depth in contact, of all three axes.
double slope_squares(const Response& response) {
  const ResponseCurves& c = response.curves;
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t j = 0; j + 1 < response.knots(); ++j) {
    const double seen = std::min(response.seen[j], response.seen[j + 1]);
    for (const auto* curve : {&c.normal_N, &c.side_N[0], &c.side_N[1]})
      sum += seen * std::pow(((*curve)[j + 1] - (*curve)[j]) / response.grid.spacing_m, 2);
    weight += seen;
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

std::vector<double> tracker_power_N2(const FeltSeries& felt, const Response& response, const Thresholds& thresholds) {
  constexpr int kSteps = 16;  // of each band, midpoint rule
  const double density = felt.position_noise_m * felt.position_noise_m / (0.5 * felt.rate_Hz);
  const auto n = static_cast<double>(felt.smoothed_samples);
  const double slopes = slope_squares(response);
  const auto path = felt.replayed_samples > 0 ? parabola_weights(felt.replayed_samples) : std::vector<double>();
  std::vector<double> power;
  for (const double centre : band_centres_Hz()) {
    const double step_Hz = centre * (kHalfBand - 1.0 / kHalfBand) / kSteps;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double f = centre / kHalfBand + (i + 0.5) * step_Hz;
      if (f >= 0.5 * felt.rate_Hz) break;
      // What the mean of n samples lets pass.
      const double angle = std::numbers::pi * f / felt.rate_Hz;
      double passed = std::sin(n * angle) / (n * std::sin(angle));
      for (std::size_t j = 0; j < path.size(); ++j)
        passed -= path[j] * std::cos(2.0 * angle * (static_cast<double>(j) - static_cast<double>(path.size() / 2)));
      sum += passed * passed * weight_at(f, centre, thresholds) * step_Hz;
    }
    power.push_back(slopes * density * sum);
  }
  return power;
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

FastForce fast_force(const FeltSeries& felt, const Response& response, const Thresholds& thresholds) {
  FastForce fast;
  fast.nyquist_Hz = 0.5 * felt.rate_Hz;
  const FastParts parts = fast_parts(felt, response);
  fast.tracker_N2 = tracker_power_N2(felt, response, thresholds);
  const auto onset_length = static_cast<std::size_t>(std::round(kOnset_s * felt.rate_Hz));
  fast.contact = steady_power(parts, Phase::contact, felt.rate_Hz, onset_length, thresholds);
  const auto air_margin = static_cast<std::size_t>(std::round(kAirMargin_s * felt.rate_Hz));
  fast.air = steady_power(parts, Phase::air, felt.rate_Hz, air_margin, thresholds);

  const auto before = static_cast<std::size_t>(std::max(1.0, std::round(kAirBefore_s * felt.rate_Hz)));
  if (onset_length < 8) return fast;
  fast.between = window_power(parts, Phase::contact, felt.rate_Hz, onset_length, onset_length, thresholds);
  PowerSum sum(felt.rate_Hz, onset_length, false, thresholds);
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

// Power of white noise in a band, weighted as all power is (Simpson's rule).
double white_power_N2(double noise_N2_per_Hz, double centre_Hz, const Thresholds& thresholds) {
  const double width_Hz = centre_Hz * (kHalfBand - 1.0 / kHalfBand);
  const double mean_weight = (weight_at(centre_Hz / kHalfBand, centre_Hz, thresholds) + 4.0 +
                              weight_at(centre_Hz * kHalfBand, centre_Hz, thresholds)) /
                             6.0;
  return noise_N2_per_Hz * width_Hz * mean_weight;
}

// Power in contact without that of the sensor; `air` may be of another recording by the same sensor.
std::vector<double> without_noise(const FastForce& fast, const BandPower& air, double noise_N2_per_Hz,
                                  std::vector<double>& variance_N4, const Thresholds& thresholds) {
  std::vector<double> power = fast.contact.power_N2;
  for (std::size_t b = 0; b < power.size(); ++b) {
    power[b] -= fast.tracker_N2[b];
    variance_N4[b] += fast.contact.variance_N4[b];
    if (air.segments > 0) {
      power[b] -= air.power_N2[b];
      variance_N4[b] += air.variance_N4[b];
    } else {
      power[b] -= white_power_N2(noise_N2_per_Hz, band_centres_Hz()[b], thresholds);
    }
  }
  return power;
}

}  // namespace

VibrationDifference vibration_difference(const FastForce& real, const FastForce& rendered, double noise_N2_per_Hz,
                                         const Thresholds& thresholds) {
  if (real.contact.segments == 0 || rendered.contact.segments == 0) return {};
  ComparedPower power;
  power.variance_N4.assign(band_centres_Hz().size(), 0.0);
  const bool own_air = real.air.segments >= kWantedAir && rendered.air.segments >= kWantedAir;
  const BandPower& more_air = real.air.segments >= rendered.air.segments ? real.air : rendered.air;
  power.real_N2 = without_noise(real, own_air ? real.air : more_air, noise_N2_per_Hz, power.variance_N4, thresholds);
  power.rendered_N2 =
      without_noise(rendered, own_air ? rendered.air : more_air, noise_N2_per_Hz, power.variance_N4, thresholds);
  // Below one and a half bins of the shorter segments the taper lets the slow force in.
  const double lowest = 1.5 / std::min(real.contact.segment_s, rendered.contact.segment_s);
  return difference(power, 1.0, std::max(19.0, lowest), std::min(real.nyquist_Hz, rendered.nyquist_Hz), thresholds);
}

VibrationDifference transient_difference(const FastForce& real, const FastForce& rendered,
                                         const Thresholds& thresholds) {
  if (real.onsets < kFewestOnsets || rendered.onsets < kFewestOnsets) return {};
  const std::size_t bands = band_centres_Hz().size();
  ComparedPower power{real.onset.power_N2, rendered.onset.power_N2, std::vector<double>(bands, 0.0), {}};
  const double scale = std::pow(real.onset_speed_m_per_s / rendered.onset_speed_m_per_s, 2);
  const auto less_steady = [&](std::vector<double>& own, const FastForce& fast, double factor) {
    for (std::size_t b = 0; b < bands; ++b) {
      power.variance_N4[b] += fast.onset.variance_N4[b] * factor * factor;
      if (fast.between.segments > 0) {
        own[b] -= fast.between.power_N2[b];
        power.variance_N4[b] += fast.between.variance_N4[b] * factor * factor;
      }
      own[b] *= factor;
    }
  };
  less_steady(power.real_N2, real, 1.0);
  less_steady(power.rendered_N2, rendered, scale);
  // What goes on vibrating masks the burst: the stronger of the two.
  std::vector<double> unused_N4(bands, 0.0);
  for (const FastForce* fast : {&real, &rendered}) {
    if (fast->contact.segments == 0) continue;
    const auto steady_N2 = without_noise(*fast, fast->air, 0.0, unused_N4, thresholds);
    if (power.masker_N2.empty()) power.masker_N2.assign(bands, 0.0);
    for (std::size_t b = 0; b < bands; ++b) power.masker_N2[b] = std::max(power.masker_N2[b], steady_N2[b]);
  }
  const double factor = std::sqrt(std::max(1.0, thresholds.vibration_integration_s / kOnset_s));
  return difference(power, factor, 39.0, std::min(real.nyquist_Hz, rendered.nyquist_Hz), thresholds);
}

}  // namespace touchstone::perception
