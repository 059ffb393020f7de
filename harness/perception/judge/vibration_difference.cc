#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "harness/perception/judge/growth.h"
#include "harness/perception/judge/like_windows.h"
#include "harness/perception/judge/vibration.h"
#include "harness/perception/judge/vibration_scale.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

constexpr std::size_t wanted_air = 4;
constexpr std::size_t fewest_onsets = 3;
constexpr double certain_errors = 2.0;     // of a power that is there
constexpr double allowed_by_noise = 0.05;  // share of identical pairs that may exceed what noise reaches

// One of the two processes: its power without noise, and what that was made of, the vibration itself first.
struct ComparedPower {
  std::vector<double> power_N2;
  std::vector<const BandPower*> parts;
  double factor = 1.0;  // that the parts' powers are multiplied by
  // Errors by another hand: of the law of growth, the same in all bands, and of noise that would grow with it.
  std::vector<double> hand_N2 = std::vector<double>(band_centres_Hz().size(), 0.0);
  std::vector<double> hand_variance_N4 = hand_N2;

  // Where the power without noise lies in a band, octaves from its centre: noise lies at the centre on average.
  [[nodiscard]] double octaves(std::size_t band) const {
    const double half = std::log2(half_band_ratio);
    const double moment = factor * parts[0]->power_N2[band] * parts[0]->octaves[band];
    return power_N2[band] > 0.0 ? std::clamp(moment / power_N2[band], -half, half) : 0.0;
  }
};

struct BandRange {
  double lowest_Hz = 0.0;
  double highest_Hz = 0.0;
  double threshold_factor = 1.0;

  [[nodiscard]] bool holds(double centre_Hz) const {
    return centre_Hz >= lowest_Hz && centre_Hz * half_band_ratio <= highest_Hz;
  }
  // Mean square of the sine that is just felt.
  [[nodiscard]] double threshold_N2(double centre_Hz, const Thresholds& thresholds) const {
    return std::pow(threshold_factor * thresholds.vibration_force_N(centre_Hz), 2) / 2.0;
  }
};

// Errors of the difference of the powers, in squares of the threshold's power.
struct PowerErrors {
  std::vector<double> by_band;
  double of_sum = 0.0;
  double degrees = 1.0;   // with which of_sum is known
  double of_hands = 0.0;  // part of of_sum
};

PowerErrors errors_of(const ComparedPower& real, const ComparedPower& rendered, const BandRange& range,
                      const Thresholds& thresholds) {
  const auto& centres = band_centres_Hz();
  PowerErrors errors{std::vector<double>(centres.size(), 0.0)};
  double uncertain = 0.0;
  for (const ComparedPower* side : {&real, &rendered}) {
    for (std::size_t p = 0; p < side->parts.size(); ++p) {
      const BandPower& part = *side->parts[p];
      double gaussian = 0.0;
      std::vector<double> sums(part.segments, 0.0);
      for (std::size_t b = 0; b < centres.size(); ++b) {
        if (!range.holds(centres[b])) continue;
        const double unit = side->factor / range.threshold_N2(centres[b], thresholds);
        // Noise alone has the same power in both: their mean is known better than either.
        const double alike_N2 =
            p == 0
                ? 0.5 * (real.factor * real.parts[0]->power_N2[b] + rendered.factor * rendered.parts[0]->power_N2[b]) /
                      side->factor
                : part.power_N2[b];
        const double by_noise = part.gaussian_share[b] * alike_N2 * alike_N2;
        errors.by_band[b] += std::max(part.variance_N4[b], by_noise) * unit * unit;
        gaussian += by_noise * unit * unit;
        for (std::size_t w = 0; w < part.segments; ++w) sums[w] += part.windows_N2[w][b] * unit;
      }
      const auto n = static_cast<double>(part.segments);
      double mean = 0.0;
      for (const double sum : sums) mean += sum / n;
      double seen = n > 1.0 ? 0.0 : mean * mean;
      for (const double sum : sums) seen += n > 1.0 ? std::pow(sum - mean, 2) / (n * (n - 1.0)) : 0.0;
      const double variance = std::max(seen, gaussian);
      errors.of_sum += variance;
      uncertain += variance * variance / std::max(1.0, n - 1.0);
    }
  }
  for (const ComparedPower* side : {&real, &rendered}) {
    // The same in all bands: what it adds to their sum is shared out, so that it adds as much to how they are spread.
    double sum = 0.0;
    double noise = 0.0;
    std::vector<double> own(centres.size(), 0.0);
    for (std::size_t b = 0; b < centres.size(); ++b) {
      if (!range.holds(centres[b])) continue;
      const double unit = 1.0 / range.threshold_N2(centres[b], thresholds);
      own[b] = side->hand_N2[b] * unit;
      sum += own[b];
      errors.by_band[b] += side->hand_variance_N4[b] * unit * unit;
      noise += side->hand_variance_N4[b] * unit * unit;
    }
    for (std::size_t b = 0; b < centres.size(); ++b) errors.by_band[b] += own[b] * sum;
    errors.of_sum += sum * sum + noise;
    errors.of_hands += sum * sum + noise;
  }
  if (uncertain > 0.0) errors.degrees = std::max(1.0, errors.of_sum * errors.of_sum / uncertain);
  return errors;
}

// d'^2 of one cue: a sum of squares whose terms are known with an error.
struct SquaredEvidence {
  double square = 0.0;
  double exceeds = 0.0;   // what exceeds all that noise alone reaches; may be below 0
  double variance = 0.0;  // of the root
  double by_noise = 0.0;  // what noise adds to the square on average
};

// A spectrum's power in one band, over that of the threshold, and where it lies.
struct SpectralLine {
  double power = 0.0;
  double octaves = 0.0;  // above 1 Hz
};

// How the power is spread: the squared distance of the two spectra after the observer's blur,
//   sum over i, j of x_i x_j likeness(i, j)
// with the real one's lines positive and the rendered one's negative. Noise of variance v_b in band b adds sum v_b on
// average, since a line is like itself, and is nearly a sum of h equal squares (Satterthwaite 1946). `lines`: for each
// band that of the real process, then that of the rendered one.
SquaredEvidence spread_evidence(const std::vector<SpectralLine>& lines, const std::vector<double>& variance,
                                const std::vector<double>& centres_octaves, double share, double degrees,
                                const VibrationScale& scale) {
  const auto blurred_at = [&](double octaves) {
    double sum = 0.0;
    for (const SpectralLine& line : lines) sum += line.power * scale.likeness(line.octaves - octaves);
    return sum;
  };
  double square = 0.0;
  for (const SpectralLine& line : lines) square += line.power * blurred_at(line.octaves);
  square = std::max(0.0, square);
  double noise = 0.0;
  double noise_squares = 0.0;
  double along = 0.0;
  for (std::size_t b = 0; b < variance.size(); ++b) {
    noise += variance[b];
    for (std::size_t c = 0; c < variance.size(); ++c)
      noise_squares += variance[b] * variance[c] * std::pow(scale.likeness(centres_octaves[b] - centres_octaves[c]), 2);
    along += variance[b] * std::pow(blurred_at(centres_octaves[b]), 2);
  }
  if (!(noise > 0.0)) return {square, square, 0.0, 0.0};
  const double h = noise * noise / noise_squares;
  const double exceeds = square - noise * stats::f_quantile(share, h, degrees);
  if (exceeds > 0.0) return {square - noise, exceeds, along / square, noise};
  // Nothing is found: what may be hidden is a vibration in the bands that differ most, not one in all of them at once.
  double squares = 0.0;
  double variance_along = 0.0;
  for (std::size_t b = 0; b < variance.size(); ++b) {
    const double apart = lines[2 * b].power + lines[2 * b + 1].power;
    squares += apart * apart;
    variance_along += apart * apart * variance[b];
  }
  return {square - noise, exceeds, squares > 0.0 ? variance_along / squares : noise, noise};
}

// `looks`: how many cues of one pair share the error.
VibrationDifference difference(const ComparedPower& real, const ComparedPower& rendered,
                               const std::vector<double>& masker_N2, const BandRange& range, double looks,
                               const Thresholds& thresholds) {
  VibrationDifference result;
  result.known = true;
  const auto& centres = band_centres_Hz();
  const VibrationScale scale(thresholds);
  const PowerErrors errors = errors_of(real, rendered, range, thresholds);
  double sums[2] = {};  // real and rendered, power over that of the threshold
  double beside = 0.0;
  double most = -1.0;
  double real_most = 0.0;
  std::vector<SpectralLine> lines;
  std::vector<double> variances;
  std::vector<double> centres_octaves;
  VibrationPitch pitch;
  double strongest[2] = {};
  for (std::size_t b = 0; b < centres.size(); ++b) {
    if (!range.holds(centres[b])) continue;
    const double t2 = range.threshold_N2(centres[b], thresholds);
    if (!masker_N2.empty()) beside += masker_N2[b] / t2;
    variances.push_back(errors.by_band[b]);
    centres_octaves.push_back(std::log2(centres[b]));
    double own[2] = {};
    for (const std::size_t side : {0u, 1u}) {
      const ComparedPower& process = side == 0 ? real : rendered;
      sums[side] += process.power_N2[b] / t2;
      own[side] = std::max(0.0, process.power_N2[b] / t2);
      const double at = centres_octaves.back() + process.octaves(b);
      lines.push_back({side == 0 ? own[side] : -own[side], at});
      if (!(own[side] > strongest[side])) continue;
      strongest[side] = own[side];
      (side == 0 ? pitch.real_N : pitch.rendered_N) = std::sqrt(own[side] * t2);
      (side == 0 ? pitch.real_Hz : pitch.rendered_Hz) = std::exp2(at);
    }
    if (std::abs(own[1] - own[0]) > most) {
      most = std::abs(own[1] - own[0]);
      real_most = own[0];
      result.frequency_Hz = centres[b];
      result.real_N = std::sqrt(own[0] * t2);
      result.rendered_N = std::sqrt(own[1] * t2);
      result.threshold_N = std::sqrt(t2);
    }
  }
  const double real_sum = std::max(0.0, sums[0]);
  const double rendered_sum = std::max(0.0, sums[1]);
  const double share = 1.0 - allowed_by_noise / looks;
  const double reach = stats::f_quantile(share, 1.0, errors.degrees);
  const double apart = rendered_sum - real_sum;
  const SquaredEvidence strength{apart * apart, apart * apart - reach * errors.of_sum, errors.of_sum, errors.of_sum};
  const SquaredEvidence spread = spread_evidence(lines, variances, centres_octaves, share, errors.degrees, scale);
  const SquaredEvidence& better = strength.exceeds >= spread.exceeds ? strength : spread;
  const double observer = scale.noise_between(real_sum + beside, rendered_sum + beside);
  // The noise's mean share is taken off, not all that it may reach: what is beyond its reach would else read too small.
  result.jnd = better.exceeds > 0.0 ? std::sqrt(std::max(0.0, better.square - better.by_noise)) / observer : 0.0;
  result.measured_jnd = std::sqrt(std::max(0.0, better.square)) / observer;
  // As a normal error with the same reach. That the looks share 5 % is for what is found, not for how much may be
  // hidden.
  constexpr double normal95 = 1.959964;
  const double errors_reached = better.exceeds > 0.0
                                    ? std::sqrt(reach)
                                    : std::sqrt(stats::f_quantile(1.0 - allowed_by_noise, 1.0, errors.degrees));
  result.standard_error = errors_reached * std::sqrt(better.variance) / (normal95 * observer);
  result.by_hand = errors.of_hands > 0.5 * errors.of_sum;
  result.allowed_N =
      result.threshold_N * (std::sqrt(real_most + scale.noticed_from(real_sum + beside)) - std::sqrt(real_most));
  constexpr double one_strength = 0.25;  // of the stronger's power: what differs is the frequency
  if (&better == &spread && std::min(strongest[0], strongest[1]) > one_strength * std::max(strongest[0], strongest[1]))
    result.pitch = pitch;
  return result;
}

// Power of white noise of 1 N^2/Hz in a band, weighted as all power is (Simpson's rule).
double white_power_Hz(double centre_Hz, const Thresholds& thresholds) {
  const double width_Hz = centre_Hz * (half_band_ratio - 1.0 / half_band_ratio);
  const double mean_weight = (band_weight(centre_Hz / half_band_ratio, centre_Hz, thresholds) + 4.0 +
                              band_weight(centre_Hz * half_band_ratio, centre_Hz, thresholds)) /
                             6.0;
  return width_Hz * mean_weight;
}

// The sensor's noise in free air: its density is the median over seven neighbouring bands. A sensor's noise is smooth
// over frequency; what stands out of it is felt.
std::vector<double> sensor_noise_N2(const BandPower& air, double nyquist_Hz, const Thresholds& thresholds) {
  const auto& centres = band_centres_Hz();
  std::vector<double> density;
  for (std::size_t b = 0; b < centres.size() && centres[b] * half_band_ratio <= nyquist_Hz; ++b)
    density.push_back(air.power_N2[b] / white_power_Hz(centres[b], thresholds));
  std::vector<double> noise(centres.size(), 0.0);
  constexpr std::size_t reach_bands = 3;
  for (std::size_t b = 0; b < density.size(); ++b) {
    const std::size_t first = b < reach_bands ? 0 : b - reach_bands;
    const std::size_t last = std::min(density.size(), b + reach_bands + 1);
    noise[b] = stats::median({density.begin() + static_cast<std::ptrdiff_t>(first),
                              density.begin() + static_cast<std::ptrdiff_t>(last)}) *
               white_power_Hz(centres[b], thresholds);
  }
  return noise;
}

// In contact, without the noise of tracker and sensor; `air` may be of another recording by the same sensor.
ComparedPower in_contact(const FastForce& fast, const BandPower& contact, const BandPower& air, double noise_N2_per_Hz,
                         const Thresholds& thresholds) {
  ComparedPower result{contact.power_N2, {&contact}};
  if (air.segments > 0) result.parts.push_back(&air);
  const auto noise_N2 = air.segments > 0 ? sensor_noise_N2(air, fast.nyquist_Hz, thresholds) : std::vector<double>();
  for (std::size_t b = 0; b < result.power_N2.size(); ++b) {
    result.power_N2[b] -= fast.tracker_N2[b];
    result.power_N2[b] -=
        noise_N2.empty() ? noise_N2_per_Hz * white_power_Hz(band_centres_Hz()[b], thresholds) : noise_N2[b];
  }
  return result;
}

ComparedPower in_air(const FastForce& fast, const Thresholds& thresholds) {
  ComparedPower result{fast.air.power_N2, {&fast.air}};
  const auto noise_N2 = sensor_noise_N2(fast.air, fast.nyquist_Hz, thresholds);
  for (std::size_t b = 0; b < noise_N2.size(); ++b) result.power_N2[b] -= noise_N2[b];
  return result;
}

// How the hand of the real process met the object beside that of the rendered one.
struct HandRatio {
  double speed = 1.0;  // of contact
  double time = 1.0;   // in contact, of each

  // `decaying_N2` of a rendered process at the real one's hand: its power, and how far the law of growth may be off in
  // the direction of `real_N2`, as standard error.
  [[nodiscard]] std::pair<double, double> at_real_hand(double decaying_N2, double steady_N2, double real_N2) const {
    constexpr double bound = 0.5;  // a bound is two standard errors
    const GrowthBounds growth = growth_bounds(speed, 2.0);
    const double scaled_N2 = decaying_N2 * growth.by_law / time;
    const bool more = real_N2 > steady_N2 + scaled_N2;
    const double bound_N2 = more ? std::max(growth.most / time, 1.0) : std::min(growth.least / time, 1.0);
    return {scaled_N2, bound * std::abs(decaying_N2 * bound_N2 - scaled_N2)};
  }
  // What an error of the power at the rendered hand comes to at the real one's, beyond that error itself.
  [[nodiscard]] double error_factor() const {
    const GrowthBounds growth = growth_bounds(speed, 2.0);
    return std::hypot(growth.by_law / time - 1.0, 0.5 * (growth.most - growth.least) / time);
  }
};

HandRatio hands_of(const FastForce& real, const FastForce& rendered) {
  if (real.onsets < fewest_onsets || rendered.onsets < fewest_onsets) return {};
  const auto time_of = [](const FastForce& fast) {
    return fast.contact.segment_s * static_cast<double>(fast.contact.segments) / static_cast<double>(fast.onsets);
  };
  return {real.onset_speed_m_per_s / rendered.onset_speed_m_per_s,
          real.contact.segments > 0 && rendered.contact.segments > 0 ? time_of(real) / time_of(rendered) : 1.0};
}

// The windows of `contact` that begin so late after contact that what rings has died away; where there are few, the
// later half if it is later by a longer ring than the early ones show.
std::vector<std::size_t> late_windows(const BandPower& contact) {
  constexpr double rings_s = 0.25;
  constexpr double later_s = 0.05;
  constexpr std::size_t fewest_late = 3;
  std::vector<double> since = contact.since_contact_s;
  std::sort(since.begin(), since.end());
  double from_s = rings_s;
  if (since.size() < fewest_late || since[since.size() - fewest_late] < rings_s) {
    from_s = since[since.size() / 2];
    if (!(from_s - since.front() > later_s)) return {};
  }
  std::vector<std::size_t> late;
  for (std::size_t w = 0; w < contact.segments; ++w) {
    if (contact.since_contact_s[w] >= from_s) late.push_back(w);
  }
  return late;
}

// The part of a power that dies away after contact, and its standard error: the mean over all windows less that over
// the late ones. Where none are late, all that is above noise may be of that kind.
std::pair<double, double> decaying_N2(const BandPower& contact, const std::vector<std::size_t>& late,
                                      double without_noise_N2, std::size_t band) {
  const double above_noise_N2 = std::max(0.0, without_noise_N2);
  if (late.size() == contact.segments) return {0.0, 0.0};
  if (late.size() < 2) return {above_noise_N2, std::sqrt(contact.variance_N4[band])};
  std::vector<double> powers_N2;
  for (const std::size_t w : late) powers_N2.push_back(contact.windows_N2[w][band]);
  const double spread_N2 = stats::standard_deviation(powers_N2);
  return {std::clamp(contact.power_N2[band] - stats::mean(powers_N2), 0.0, above_noise_N2),
          std::sqrt(spread_N2 * spread_N2 / static_cast<double>(late.size()) + contact.variance_N4[band])};
}

// Steady vibration as at the real process's hand.
void take_to_hand(ComparedPower& rendered, const ComparedPower& real, const HandRatio& hands) {
  const std::vector<std::size_t> late = late_windows(*rendered.parts[0]);
  for (std::size_t b = 0; b < rendered.power_N2.size(); ++b) {
    auto [decaying, error_N2] = decaying_N2(*rendered.parts[0], late, rendered.power_N2[b], b);
    if (decaying < certain_errors * error_N2) decaying = 0.0;
    const double steady_N2 = rendered.power_N2[b] - decaying;
    const auto [scaled_N2, growth_N2] = hands.at_real_hand(decaying, steady_N2, real.power_N2[b]);
    rendered.power_N2[b] = steady_N2 + scaled_N2;
    rendered.hand_N2[b] = growth_N2;
    rendered.hand_variance_N4[b] = std::pow(error_N2 * hands.error_factor(), 2);
  }
}

}  // namespace

VibrationDifference vibration_difference(const FastForce& real, const FastForce& rendered, double noise_N2_per_Hz,
                                         const Thresholds& thresholds) {
  if (real.contact.segments == 0 || rendered.contact.segments == 0) return {};
  const bool own_air = real.air.segments >= wanted_air && rendered.air.segments >= wanted_air;
  const BandPower& more_air = real.air.segments >= rendered.air.segments ? real.air : rendered.air;
  const double looks = own_air ? 4.0 : 2.0;
  const double highest_Hz = std::min(real.nyquist_Hz, rendered.nyquist_Hz);
  // Below one and a half bins of the shorter segments the taper lets the slow force in.
  const auto range_of = [highest_Hz](const BandPower& a, const BandPower& b) {
    return BandRange{std::max(19.0, 1.5 / std::min(a.segment_s, b.segment_s)), highest_Hz, 1.0};
  };
  const auto like = like_windows(real.contact, rendered.contact);
  const auto own =
      in_contact(real, like ? like->real : real.contact, own_air ? real.air : more_air, noise_N2_per_Hz, thresholds);
  auto other = in_contact(rendered, like ? like->rendered : rendered.contact, own_air ? rendered.air : more_air,
                          noise_N2_per_Hz, thresholds);
  take_to_hand(other, own, hands_of(real, rendered));
  if (!like) {
    for (std::size_t b = 0; b < other.power_N2.size(); ++b)
      other.hand_N2[b] = std::max(other.hand_N2[b], std::abs(other.power_N2[b] - own.power_N2[b]));
  }
  auto contact = difference(own, other, {}, range_of(real.contact, rendered.contact), looks, thresholds);
  contact.by_sliding = !like;
  if (!own_air) return contact;
  auto air = difference(in_air(real, thresholds), in_air(rendered, thresholds), {}, range_of(real.air, rendered.air),
                        looks, thresholds);
  air.in_air = true;
  return air.jnd > contact.jnd ? air : contact;
}

VibrationDifference transient_difference(const FastForce& real, const FastForce& rendered,
                                         const Thresholds& thresholds) {
  if (real.onsets < fewest_onsets || rendered.onsets < fewest_onsets) return {};
  const std::size_t bands = band_centres_Hz().size();
  const HandRatio hands{real.onset_speed_m_per_s / rendered.onset_speed_m_per_s};
  const auto burst = [&](const FastForce& fast, double factor) {
    ComparedPower result{fast.onset.power_N2, {&fast.onset}, factor};
    if (fast.between.segments > 0) result.parts.push_back(&fast.between);
    for (std::size_t b = 0; b < bands; ++b) {
      if (fast.between.segments > 0) result.power_N2[b] -= fast.between.power_N2[b];
    }
    return result;
  };
  const ComparedPower own = burst(real, 1.0);
  ComparedPower other = burst(rendered, hands.speed * hands.speed);
  for (std::size_t b = 0; b < bands; ++b) {
    // What is not certain to be there does not grow, but for its error.
    const double error_N2 = std::sqrt(rendered.onset.variance_N4[b]);
    const double above_N2 = other.power_N2[b] < certain_errors * error_N2 ? 0.0 : other.power_N2[b];
    const double growth_N2 = hands.at_real_hand(above_N2, 0.0, own.power_N2[b]).second;
    other.power_N2[b] *= other.factor;
    other.hand_N2[b] = growth_N2;
    other.hand_variance_N4[b] = std::pow(error_N2 * hands.error_factor(), 2);
  }
  // What goes on vibrating masks the burst: the stronger of the two.
  std::vector<double> masker_N2(bands, 0.0);
  for (const FastForce* fast : {&real, &rendered}) {
    if (fast->contact.segments == 0) continue;
    const auto steady = in_contact(*fast, fast->contact, fast->air, 0.0, thresholds);
    for (std::size_t b = 0; b < bands; ++b) masker_N2[b] = std::max(masker_N2[b], steady.power_N2[b]);
  }
  const BandRange range{39.0, std::min(real.nyquist_Hz, rendered.nyquist_Hz),
                        std::sqrt(std::max(1.0, thresholds.vibration_integration_s / onset_s))};
  return difference(own, other, masker_N2, range, 2.0, thresholds);
}

}  // namespace touchstone::perception
