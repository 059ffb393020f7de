#include "harness/perception/judge/vibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/perception/fourier.h"
#include "harness/perception/judge/replay_path.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {
namespace {

constexpr double air_before_s = 0.02;
constexpr double air_margin_s = 0.024;  // around contact: longer than the smoothing of positions
constexpr std::array<double, 3> segments_s{0.256, 0.128, 0.064};
constexpr std::size_t wanted_segments = 4;

// edge: in contact, but soon after or before the air, or where sliding begins, turns or ends: force that the response
// does not follow is no vibration there.
enum class Phase : unsigned char { air, contact, edge };

struct FastParts {
  const FeltSeries* felt = nullptr;
  std::array<std::vector<double>, 3> residual_N;
  std::vector<Phase> phase;
};

// Third-octave band that holds the frequency; -1: none.
int band_of(double f_Hz) {
  const auto& centres = band_centres_Hz();
  if (f_Hz < centres.front() / half_band_ratio || f_Hz >= centres.back() * half_band_ratio) return -1;
  const auto band = static_cast<int>(std::lround(3.0 * std::log2(f_Hz / centres.front())));
  return std::clamp(band, 0, static_cast<int>(centres.size()) - 1);
}

class PowerSum {
 public:
  // `taper`: Hann, and the mean is taken out. Else the samples as they are, and a parabola is taken out: what bends
  // more slowly than the window would leak into every band at its ends.
  PowerSum(double rate_Hz, std::size_t length, bool taper, const Thresholds& thresholds)
      : rate_Hz_(rate_Hz),
        length_(length),
        taper_(taper),
        window_(length, 1.0),
        sum_(band_centres_Hz().size(), 0.0),
        squares_(sum_),
        of_axis_{sum_, sum_, sum_} {
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
      from_centre_.push_back(band >= 0 ? std::log2(f / band_centres_Hz()[static_cast<std::size_t>(band)]) : 0.0);
      weight_.push_back(
          band >= 0 ? scale * band_weight(f, band_centres_Hz()[static_cast<std::size_t>(band)], thresholds) : 0.0);
    }
  }

  void add(const FastParts& parts, std::size_t first,
           double since_contact_s = std::numeric_limits<double>::infinity()) {
    const auto& x = parts.residual_N;
    const auto mean_of = [&](const std::vector<double>& of) {
      double sum = 0.0;
      for (std::size_t i = first; i < first + length_; ++i) sum += of[i];
      return sum / static_cast<double>(length_);
    };
    power_.since_contact_s.push_back(since_contact_s);
    power_.slide_m_per_s.push_back(mean_of(parts.felt->slide_m_per_s));
    power_.load_N.push_back(mean_of(parts.felt->force_N[0]));
    std::vector<double> bands(sum_.size(), 0.0);
    std::vector<double> octaves(sum_.size(), 0.0);
    std::vector<double> segment(length_);
    for (std::size_t a = 0; a < x.size(); ++a) {
      const auto& axis = x[a];
      const double mean = mean_of(axis);
      for (std::size_t i = 0; i < length_; ++i) segment[i] = window_[i] * (axis[first + i] - mean);
      for (const auto& slow : slow_) {
        double along = 0.0;
        for (std::size_t i = 0; i < length_; ++i) along += slow[i] * segment[i];
        for (std::size_t i = 0; i < length_; ++i) segment[i] -= along * slow[i];
      }
      const auto spectrum = real_fourier(segment);
      for (std::size_t k = 1; 2 * k < length_; ++k) {
        if (band_[k] < 0) continue;
        const auto band = static_cast<std::size_t>(band_[k]);
        const double power = weight_[k] * std::norm(spectrum[k]);
        bands[band] += power;
        octaves[band] += power * from_centre_[k];
        of_axis_[a][band] += power;
      }
    }
    for (std::size_t b = 0; b < bands.size(); ++b) {
      sum_[b] += bands[b];
      squares_[b] += bands[b] * bands[b];
    }
    power_.windows_N2.push_back(std::move(bands));
    power_.windows_octaves.push_back(std::move(octaves));
    ++count_;
  }

  [[nodiscard]] BandPower result() const {
    BandPower power = power_;
    power.segments = count_;
    power.segment_s = static_cast<double>(length_) / rate_Hz_;
    if (count_ == 0) return power;
    const auto n = static_cast<double>(count_);
    for (std::size_t b = 0; b < sum_.size(); ++b) {
      const double mean = sum_[b] / n;
      power.power_N2.push_back(mean);
      const double spread = n > 1.0 ? std::max(0.0, (squares_[b] - n * mean * mean) / (n - 1.0)) : mean * mean;
      power.variance_N4.push_back(spread / n);
      double moment = 0.0;
      for (const auto& window : power.windows_octaves) moment += window[b];
      power.octaves.push_back(sum_[b] > 0.0 ? moment / sum_[b] : 0.0);
      // The power of one axis of white noise has 2 / (2 bins) of its square as variance; a taper makes neighbouring
      // bins share what they show, one and a half for one (Welch 1967).
      const auto in_band = static_cast<double>(std::count(band_.begin(), band_.end(), static_cast<int>(b)));
      double squares = 0.0;
      for (const auto& axis : of_axis_) squares += std::pow(axis[b] / n, 2);
      const double bins = std::max(1.0, in_band / (taper_ ? 1.5 : 1.0));
      power.gaussian_share.push_back(mean > 0.0 ? squares / (mean * mean * bins * n) : 0.0);
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
  bool taper_;
  std::vector<double> window_;
  std::vector<std::vector<double>> slow_;  // taken out beside the mean
  std::vector<double> sum_;
  std::vector<double> squares_;
  std::array<std::vector<double>, 3> of_axis_;
  BandPower power_;                  // its windows
  std::vector<int> band_;            // of each frequency of the spectrum
  std::vector<double> from_centre_;  // octaves, of each frequency
  std::vector<double> weight_;       // of each frequency's power
  std::size_t count_ = 0;
};

// Makes edges of the samples in contact that are less than `margin` from one that `breaks`.
template <class Breaks>
void mark_edges(std::vector<Phase>& phase, std::size_t margin, Breaks breaks) {
  const std::size_t n = phase.size();
  std::vector<std::size_t> marks(n + 1, 0);  // how many break before
  for (std::size_t i = 0; i < n; ++i) marks[i + 1] = marks[i] + (breaks(i) ? 1 : 0);
  for (std::size_t i = 0; i < n; ++i) {
    const bool near = marks[std::min(n, i + margin + 1)] > marks[i < margin ? 0 : i - margin];
    if (near && phase[i] == Phase::contact) phase[i] = Phase::edge;
  }
}

// Speeds below this share of the root mean square in contact are a turn of the hand.
constexpr double turning = 0.3;
constexpr double sliding_m_per_s = 0.005;  // root mean square: less is a hand at rest
constexpr double even_direction_s = 0.1;   // two periods of the lowest vibration that is judged

// The direction of sliding by a Hann window of 0.1 s, which lets nothing through from 20 Hz on: friction times the
// tracker's noise in the direction would look like a vibration that the force never had. No window reaches over a turn,
// where the direction jumps.
FeltSeries with_even_direction(const FeltSeries& felt, double typical_m_per_s) {
  FeltSeries even = felt;
  const auto reach = static_cast<std::size_t>(std::round(0.5 * even_direction_s * felt.rate_Hz));
  std::vector<double> window(reach + 1);
  for (std::size_t k = 0; k <= reach; ++k) {
    window[k] = 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(k) / (static_cast<double>(reach) + 1.0));
  }
  const auto turns = [&](std::size_t i) { return felt.slide_m_per_s[i] < turning * typical_m_per_s; };
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (turns(i)) continue;
    double weight = window[0];
    double x = window[0] * felt.slide_x[i];
    double y = window[0] * felt.slide_y[i];
    const auto add = [&](std::size_t at, std::size_t k) {
      weight += window[k];
      x += window[k] * felt.slide_x[at];
      y += window[k] * felt.slide_y[at];
    };
    for (std::size_t k = 1; k <= std::min(reach, i) && !turns(i - k); ++k) add(i - k, k);
    for (std::size_t k = 1; k <= reach && i + k < felt.size() && !turns(i + k); ++k) add(i + k, k);
    even.slide_x[i] = x / weight;
    even.slide_y[i] = y / weight;
  }
  return even;
}

FastParts fast_parts(const FeltSeries& felt, const Response& response) {
  FastParts parts;
  parts.felt = &felt;
  for (auto& axis : parts.residual_N) axis.resize(felt.size());
  parts.phase.resize(felt.size());
  double squares = 0.0;
  double in_contact = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const double d = felt.depth_m[i] - response.contact_m;
    parts.phase[i] = d >= 0.0 ? Phase::contact : Phase::air;
    if (d >= 0.0) {
      squares += felt.slide_m_per_s[i] * felt.slide_m_per_s[i];
      in_contact += 1.0;
    }
  }
  const double typical_m_per_s = in_contact > 0.0 ? std::sqrt(squares / in_contact) : 0.0;
  const bool slides = typical_m_per_s > sliding_m_per_s;
  const FeltSeries even = slides ? with_even_direction(felt, typical_m_per_s) : felt;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const auto expected = expected_force_N(response, even, response.contact_m, i);
    for (std::size_t a = 0; a < 3; ++a) parts.residual_N[a][i] = felt.force_N[a][i] - expected[a];
  }
  // The band around first contact is neither: a kink is no vibration.
  std::vector<bool> air(felt.size());
  for (std::size_t i = 0; i < felt.size(); ++i) air[i] = parts.phase[i] == Phase::air;
  mark_edges(parts.phase, static_cast<std::size_t>(std::round(onset_s * felt.rate_Hz)),
             [&](std::size_t i) { return air[i]; });
  if (slides) {
    mark_edges(parts.phase, static_cast<std::size_t>(std::round(0.5 * onset_s * felt.rate_Hz)),
               [&](std::size_t i) { return felt.slide_m_per_s[i] < turning * typical_m_per_s; });
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
    for (std::size_t at = first; at + length <= end; at += length) sum.add(parts, at);
  }
  return sum.result();
}

BandPower steady_power(const FastParts& parts, Phase phase, double rate_Hz, std::size_t margin,
                       const Thresholds& thresholds) {
  const auto stretches = runs(parts.phase, phase, margin);
  for (const double segment_s : segments_s) {
    const auto length = static_cast<std::size_t>(std::round(segment_s * rate_Hz));
    if (length < 4) continue;
    std::size_t available = 0;
    for (const auto& [first, end] : stretches) {
      if (end - first >= length) available += 1 + (end - first - length) / std::max<std::size_t>(1, length / 2);
    }
    if (available < wanted_segments && segment_s != segments_s.back()) continue;
    PowerSum sum(rate_Hz, length, true, thresholds);
    std::optional<std::size_t> last_air;
    std::size_t seen = 0;
    for (const auto& [first, end] : stretches) {
      for (; seen < first; ++seen) {
        if (parts.phase[seen] == Phase::air) last_air = seen;
      }
      for (std::size_t at = first; at + length <= end; at += std::max<std::size_t>(1, length / 2)) {
        sum.add(parts, at,
                last_air ? static_cast<double>(at - *last_air) / rate_Hz : std::numeric_limits<double>::infinity());
      }
    }
    return sum.result();
  }
  return {};
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
  constexpr int steps = 16;  // of each band, midpoint rule
  const double density = felt.position_noise_m * felt.position_noise_m / (0.5 * felt.rate_Hz);
  const auto n = static_cast<double>(felt.smoothed_samples);
  const double slopes = slope_squares(response);
  const auto path = felt.replayed_samples > 0 ? parabola_weights(felt.replayed_samples) : std::vector<double>();
  std::vector<double> power;
  for (const double centre : band_centres_Hz()) {
    const double step_Hz = centre * (half_band_ratio - 1.0 / half_band_ratio) / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double f = centre / half_band_ratio + (i + 0.5) * step_Hz;
      if (f >= 0.5 * felt.rate_Hz) break;
      // What the mean of n samples lets pass.
      const double angle = std::numbers::pi * f / felt.rate_Hz;
      double passed = std::sin(n * angle) / (n * std::sin(angle));
      for (std::size_t j = 0; j < path.size(); ++j)
        passed -= path[j] * std::cos(2.0 * angle * (static_cast<double>(j) - static_cast<double>(path.size() / 2)));
      sum += passed * passed * band_weight(f, centre, thresholds) * step_Hz;
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

double band_weight(double f_Hz, double centre_Hz, const Thresholds& thresholds) {
  return std::pow(thresholds.vibration_force_N(centre_Hz) / thresholds.vibration_force_N(f_Hz), 2);
}

FastForce fast_force(const FeltSeries& felt, const Response& response, const Thresholds& thresholds) {
  FastForce fast;
  fast.nyquist_Hz = 0.5 * felt.rate_Hz;
  const FastParts parts = fast_parts(felt, response);
  fast.tracker_N2 = tracker_power_N2(felt, response, thresholds);
  const auto onset_length = static_cast<std::size_t>(std::round(onset_s * felt.rate_Hz));
  fast.contact = steady_power(parts, Phase::contact, felt.rate_Hz, 0, thresholds);
  const auto air_margin = static_cast<std::size_t>(std::round(air_margin_s * felt.rate_Hz));
  fast.air = steady_power(parts, Phase::air, felt.rate_Hz, air_margin, thresholds);

  const auto before = static_cast<std::size_t>(std::max(1.0, std::round(air_before_s * felt.rate_Hz)));
  if (onset_length < 8) return fast;
  fast.between = window_power(parts, Phase::contact, felt.rate_Hz, 0, onset_length, thresholds);
  PowerSum sum(felt.rate_Hz, onset_length, false, thresholds);
  std::vector<double> speeds;
  std::size_t air = 0;
  for (std::size_t i = 0; i + onset_length <= felt.size(); ++i) {
    if (parts.phase[i] == Phase::air) {
      ++air;
      continue;
    }
    if (air >= before && felt.rate_of_depth_m_per_s[i] > 0.0) {
      sum.add(parts, i);
      speeds.push_back(felt.rate_of_depth_m_per_s[i]);
    }
    air = 0;
  }
  fast.onset = sum.result();
  fast.onsets = speeds.size();
  if (!speeds.empty()) fast.onset_speed_m_per_s = stats::median(speeds);
  return fast;
}

}  // namespace touchstone::perception
