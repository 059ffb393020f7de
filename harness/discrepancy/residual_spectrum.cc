#include "harness/discrepancy/residual_spectrum.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "harness/discrepancy/welch.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

// Bound on the probability of any false peak in one recording of noise alone.
constexpr double false_alarm = 1e-3;
// Power over the background that a peak must have besides: the shape of the declared noise is itself only so well known
// (a coloured noise of one time constant stands for a sensor's filter). 6 dB.
constexpr double least_over_background = 4.0;
constexpr std::size_t most_peaks = 6;
// A mains frequency stays within 1 % of its nominal value in 99.5 % of the year (EN 50160:2010, 4.2.1).
constexpr double mains_tolerance = 0.01;
// Beyond it a harmonic of the mains carries next to nothing.
constexpr double last_harmonic = 10.0;
// A resonance is wider than this share of its frequency (a quality factor below 100), a tone is not.
constexpr double band_share = 0.01;
// What lies within this share of a peak's frequency is its own flank or a sideband of its modulation.
constexpr double sideband_share = 0.1;
constexpr std::size_t shortest_segment = 64;

// Running median over `reach` bins to both sides, as the mean that noise of this median has.
std::vector<double> median_background(const std::vector<double>& power, std::size_t reach, double averages) {
  const double median_of_noise = boost::math::gamma_p_inv(averages, 0.5) / averages;
  std::vector<double> background(power.size());
  for (std::size_t i = 0; i < power.size(); ++i) {
    const auto low = static_cast<std::ptrdiff_t>(i > reach ? i - reach : 1);
    const auto high = static_cast<std::ptrdiff_t>(std::min(power.size(), i + reach + 1));
    background[i] =
        stats::lower_quantile({power.begin() + std::min(low, high - 1), power.begin() + high}, 0.5) / median_of_noise;
  }
  return background;
}

// ln of the upper tail of the gamma distribution; its leading term where the tail is below the least number.
double log_tail(double shape, double x) {
  const double tail = boost::math::gamma_q(shape, x);
  if (tail > 1e-280) return std::log(tail);
  return (shape - 1.0) * std::log(x) - x - std::lgamma(shape);
}

// One segment length: the residual's spectrum with its background, and the prediction's.
struct Resolved {
  Spectra residual;
  Spectra prediction;
  std::array<std::vector<double>, 3> background_N2;
  std::vector<double> log_tail;

  [[nodiscard]] double power(std::size_t k) const {
    return residual.power_N2[0][k] + residual.power_N2[1][k] + residual.power_N2[2][k];
  }
  [[nodiscard]] double background(std::size_t k) const {
    return background_N2[0][k] + background_N2[1][k] + background_N2[2][k];
  }
  [[nodiscard]] double predicted(std::size_t k) const {
    return prediction.power_N2[0][k] + prediction.power_N2[1][k] + prediction.power_N2[2][k];
  }
  [[nodiscard]] std::size_t size() const { return residual.power_N2[0].size(); }
  [[nodiscard]] double frequency_Hz(std::size_t k) const { return static_cast<double>(k) * residual.bin_Hz; }
};

std::vector<Vec3> minus(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<Vec3> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

// What is looked at in one recording.
struct Sight {
  double step_s = 0.0;
  Axes residual;
  Axes prediction;
  std::vector<Axes> nulls;
  std::vector<Axes> replicas;
  double square_N2 = 0.0;  // mean of the raw residual's
};

std::optional<Sight> look_at(const DetectorSide& side, const Model& model) {
  const auto& t_s = side.recording->motion.t_s;
  Sight sight;
  sight.step_s = median_step_s(t_s);
  if (!(sight.step_s > 0.0) || t_s.size() < 4 * shortest_segment) return std::nullopt;
  const rendering::Prediction nominal = side.blocks->predictor->predict(model);
  const auto left = minus(side.recording->f_W_N, nominal.f_W_N);
  for (const Vec3& e : left) sight.square_N2 += e.squaredNorm() / static_cast<double>(left.size());
  sight.residual = even(t_s, left, sight.step_s);
  sight.prediction = even(t_s, nominal.f_W_N, sight.step_s);
  for (std::size_t world = 0; world < NoiseModel::null_simulations; ++world) {
    const auto null = side.noise->null_forces(model, nominal, world);
    sight.nulls.push_back(even(t_s, minus(null, nominal.f_W_N), sight.step_s));
  }
  for (std::size_t replica = 0; replica < NoiseModel::replica_count; ++replica)
    sight.replicas.push_back(even(t_s, side.noise->simulated_noise_residual(model, nominal, replica), sight.step_s));
  return sight;
}

Resolved resolve(const Sight& sight, std::size_t length) {
  Resolved scale;
  scale.residual = welch(sight.residual, sight.step_s, length);
  scale.prediction = welch(sight.prediction, sight.step_s, length);
  // Enough neighbours for a median, and so many that a line's own flanks are few among them.
  constexpr double neighbours_Hz = 4.0;
  constexpr std::size_t fewest_neighbours = 20;
  const auto reach = std::max(fewest_neighbours, static_cast<std::size_t>(neighbours_Hz / scale.residual.bin_Hz));
  // The mean of the simulated recordings is steady to a tenth once it is over a hundred periodograms.
  constexpr double periodograms = 100.0;
  const double averaged = scale.residual.averages * static_cast<double>(sight.nulls.size());
  const auto null_reach = static_cast<std::size_t>(std::ceil(0.5 * periodograms / averaged));
  for (std::size_t a = 0; a < 3; ++a) {
    scale.background_N2.at(a) = median_background(scale.residual.power_N2.at(a), reach, scale.residual.averages);
  }
  std::array<std::vector<double>, 3> null_N2;
  for (auto& axis : null_N2) axis.assign(scale.size(), 0.0);
  for (const Axes& null : sight.nulls) {
    const Spectra spectra = welch(null, sight.step_s, length);
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t k = 0; k < scale.size(); ++k) {
        null_N2.at(a)[k] += spectra.power_N2.at(a)[k] / static_cast<double>(sight.nulls.size());
      }
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const auto smooth = running_mean(null_N2.at(a), null_reach);
    for (std::size_t k = 0; k < scale.size(); ++k) {
      double& background = scale.background_N2.at(a)[k];
      background = std::max({background, smooth[k], std::numeric_limits<double>::min()});
    }
  }
  const double averages = scale.residual.averages;
  scale.log_tail.resize(scale.size());
  for (std::size_t k = 0; k < scale.size(); ++k) {
    double sum = 0.0;
    for (std::size_t a = 0; a < 3; ++a) sum += scale.residual.power_N2.at(a)[k] / scale.background_N2.at(a)[k];
    scale.log_tail[k] = log_tail(3.0 * averages, averages * sum);
  }
  return scale;
}

bool is_mains(double frequency_Hz) {
  for (const double mains_Hz : {50.0, 60.0}) {
    const double harmonic = std::round(frequency_Hz / mains_Hz);
    if (harmonic >= 1.0 && harmonic <= last_harmonic &&
        std::abs(frequency_Hz - harmonic * mains_Hz) <= mains_tolerance * harmonic * mains_Hz) {
      return true;
    }
  }
  return false;
}

// Mean square within a band at every sample's time, of the 3-D residual.
std::vector<double> band_squares(const Sight& sight, double low_Hz, double high_Hz) {
  const std::size_t n = fast_length(sight.residual[0].size());
  std::vector<double> squares(n, 0.0);
  Eigen::FFT<double> transform;
  for (const auto& axis : sight.residual) {
    std::vector<double> series(axis.begin(), axis.begin() + static_cast<std::ptrdiff_t>(n));
    std::vector<std::complex<double>> frequencies;
    transform.fwd(frequencies, series);
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      const auto folded = static_cast<double>(std::min(k, n - k));
      const double f_Hz = folded / (static_cast<double>(n) * sight.step_s);
      if (f_Hz < low_Hz || f_Hz > high_Hz) frequencies[k] = 0.0;
    }
    transform.inv(series, frequencies);
    for (std::size_t i = 0; i < n; ++i) squares[i] += series[i] * series[i];
  }
  return squares;
}

// Whether the tip slides, rests on the object or is free, on the even clock.
enum class Doing : std::uint8_t { sliding, resting, free, between };

std::vector<Doing> doing(const DetectorSide& side, const Model& model, double step_s, std::size_t n) {
  const MotionColumns& motion = side.recording->motion;
  const rendering::Prediction prediction = side.blocks->predictor->predict(model);
  // Over a tenth of a second a hand's sliding shows above a tracker's noise.
  constexpr double half_window_s = 0.05;
  const std::size_t count = motion.size();
  std::vector<double> speeds(count, 0.0);
  std::vector<double> touching;
  std::size_t low = 0;
  std::size_t high = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (motion.t_s[low] < motion.t_s[i] - half_window_s) ++low;
    while (high + 1 < count && motion.t_s[high] < motion.t_s[i] + half_window_s) ++high;
    const Vec3& normal = prediction.n_W[i];
    if (normal.isZero() || high == low) continue;
    const Vec3 v = (motion.p_W_m[high] - motion.p_W_m[low]) / (motion.t_s[high] - motion.t_s[low]);
    speeds[i] = (v - normal.dot(v) * normal).norm();
    touching.push_back(speeds[i]);
  }
  constexpr double fast_share = 0.3;
  constexpr double slow_share = 0.1;
  const double typical = touching.empty() ? 0.0 : stats::lower_quantile(std::move(touching), 0.8);
  std::vector<Doing> out(n, Doing::free);
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = motion.t_s.front() + static_cast<double>(i) * step_s;
    while (j + 1 < count && motion.t_s[j + 1] <= t) ++j;
    if (prediction.n_W[j].isZero()) continue;
    out[i] = speeds[j] > fast_share * typical   ? Doing::sliding
             : speeds[j] < slow_share * typical ? Doing::resting
                                                : Doing::between;
  }
  return out;
}

ActsWhile acts_while(const std::vector<double>& squares, const std::vector<Doing>& doing, double background_N2) {
  // A group with less has no mean to compare with; four times the power is twice the amplitude.
  constexpr double least_group = 0.03;
  constexpr double stronger = 4.0;
  const auto mean = [&](auto belongs) -> std::optional<double> {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if (!belongs(doing[i])) continue;
      sum += squares[i];
      count += 1.0;
    }
    if (count < least_group * static_cast<double>(squares.size())) return std::nullopt;
    return std::max(0.0, sum / count - background_N2);
  };
  const auto sliding = mean([](Doing d) { return d == Doing::sliding; });
  const auto resting = mean([](Doing d) { return d == Doing::resting; });
  const auto free = mean([](Doing d) { return d == Doing::free; });
  const auto touching = mean([](Doing d) { return d != Doing::free; });
  const auto exceeds = [&](const std::optional<double>& one, const std::optional<double>& other) {
    return !other || (one && *one > stronger * *other);
  };
  if (sliding && (resting || free) && exceeds(sliding, resting) && exceeds(sliding, free)) return ActsWhile::sliding;
  if (touching && free && exceeds(touching, free)) return ActsWhile::touching;
  return ActsWhile::always;
}

std::string name_of(const SpectralPeak& peak) {
  const bool band = peak.width_Hz > band_share * peak.frequency_Hz;
  if (peak.acts == ActsWhile::sliding) return "buzz while sliding";
  if (!band && peak.acts == ActsWhile::always && is_mains(peak.frequency_Hz)) return "mains hum";
  return band ? "resonance" : "tone";
}

// Peak at bin `at` of the scale: how wide, where, how strong. Nothing if the prediction shows it too.
std::optional<SpectralPeak> measure_peak(const Resolved& scale, std::size_t at) {
  const auto excess = [&](std::size_t k) { return std::max(0.0, scale.power(k) - scale.background(k)); };
  const double half = 0.5 * excess(at);
  std::size_t low = at;
  std::size_t high = at;
  while (low > 1 && excess(low - 1) > half) --low;
  while (high + 1 < scale.size() && excess(high + 1) > half) ++high;
  const std::size_t width = high - low + 1;
  // A Lorentzian has 84 % of its power within four times its width at half height; a taper's line all of it.
  const std::size_t first = low > 3 * width / 2 ? low - 3 * width / 2 : 1;
  const std::size_t last = std::min(scale.size() - 1, high + 3 * width / 2);
  SpectralPeak peak;
  double power = 0.0;
  double predicted = 0.0;
  double moment = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    power += excess(k);
    moment += excess(k) * scale.frequency_Hz(k);
    predicted += scale.predicted(k);
  }
  // The tracker's own part of the residual shows in the prediction with the same power.
  constexpr double of_motion = 0.5;
  if (predicted > of_motion * power) return std::nullopt;
  peak.frequency_Hz = moment / power;
  peak.width_Hz = static_cast<double>(width) * scale.residual.bin_Hz;
  peak.rms_N = std::sqrt(power);
  return peak;
}

// A short segment blurs a line over its own resolution. The peak at bin `at` of `found` as the longest segment shows it
// that still holds its power in one place: a resonance has its power spread over many bins there, each with a height
// of its own, so that none of them holds it.
std::optional<SpectralPeak> measure_sharpest(const std::vector<Resolved>& scales, const Resolved& found,
                                             std::size_t at) {
  auto coarse = measure_peak(found, at);
  if (!coarse) return std::nullopt;
  // Of the power: a line loses to the background under its flanks, and keeps the rest.
  constexpr double held = 0.8;
  // The taper's main lobe reaches two bins to both sides.
  const double reach_Hz = 2.0 * found.residual.bin_Hz;
  for (const Resolved& scale : scales) {  // the longest first
    if (&scale == &found) break;
    std::size_t top = 0;
    for (std::size_t k = 2; k + 2 < scale.size(); ++k) {
      if (std::abs(scale.frequency_Hz(k) - found.frequency_Hz(at)) > reach_Hz) continue;
      if (top == 0 || scale.power(k) > scale.power(top)) top = k;
    }
    if (top == 0) continue;
    auto fine = measure_peak(scale, top);
    if (fine && fine->rms_N * fine->rms_N >= held * coarse->rms_N * coarse->rms_N) return fine;
  }
  return coarse;
}

std::vector<SpectralPeak> peaks_of(const Sight& sight, const DetectorSide& side, const Model& model, double from_Hz) {
  std::vector<Resolved> scales;
  double looked_at = 0.0;
  for (std::size_t n = sight.residual[0].size(); n >= shortest_segment; n /= 4) {
    scales.push_back(resolve(sight, fast_length(n)));
    looked_at += static_cast<double>(scales.back().size());
  }
  std::vector<SpectralPeak> peaks;
  std::vector<std::pair<double, double>> taken_Hz;
  std::vector<Doing> tip;
  while (peaks.size() < most_peaks) {
    const Resolved* best = nullptr;
    std::size_t at = 0;
    double tail = std::log(false_alarm / looked_at);
    for (const Resolved& scale : scales) {
      // A taper's main lobe is four bins wide: the first ones and the last lack a side.
      for (std::size_t k = 2; k + 2 < scale.size(); ++k) {
        const double f_Hz = scale.frequency_Hz(k);
        const auto holds = [&](const auto& band) { return f_Hz >= band.first && f_Hz <= band.second; };
        if (f_Hz < from_Hz || !(scale.log_tail[k] < tail) || std::any_of(taken_Hz.begin(), taken_Hz.end(), holds) ||
            !(scale.power(k) > least_over_background * scale.background(k))) {
          continue;
        }
        best = &scale;
        at = k;
        tail = scale.log_tail[k];
      }
    }
    if (best == nullptr) break;
    const double here_Hz = best->frequency_Hz(at);
    const double aside_Hz = std::max(sideband_share * here_Hz, 3.0 * best->residual.bin_Hz);
    taken_Hz.emplace_back(here_Hz - aside_Hz, here_Hz + aside_Hz);
    auto peak = measure_sharpest(scales, *best, at);
    if (!peak) continue;
    // What another segment length shows of a peak that is there already.
    const auto is_there = [&](const SpectralPeak& other) {
      return std::abs(other.frequency_Hz - peak->frequency_Hz) <= sideband_share * other.frequency_Hz;
    };
    if (std::any_of(peaks.begin(), peaks.end(), is_there)) continue;
    peak->log10_false_alarm = std::min(0.0, (tail + std::log(looked_at)) / std::numbers::ln10);
    // Wide enough that a tenth of a second of sliding is not smeared over the rest.
    constexpr double least_half_band_Hz = 5.0;
    const double half_Hz = std::max(2.0 * peak->width_Hz, least_half_band_Hz);
    const auto squares = band_squares(sight, peak->frequency_Hz - half_Hz, peak->frequency_Hz + half_Hz);
    if (tip.empty()) tip = doing(side, model, sight.step_s, squares.size());
    const double background = best->background(at) * 2.0 * half_Hz / best->residual.bin_Hz;
    peak->acts = acts_while(squares, tip, background);
    peak->name = name_of(*peak);
    peaks.push_back(*peak);
  }
  std::sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.rms_N > b.rms_N; });
  return peaks;
}

// RMS from a frequency on.
double rms_above_N(const Axes& axes, double step_s, double from_Hz) {
  const Spectra spectra = welch(axes, step_s, fast_length(std::max(shortest_segment, axes[0].size() / 4)));
  double square = 0.0;
  for (const auto& power : spectra.power_N2) {
    for (std::size_t k = 0; k < power.size(); ++k) {
      if (static_cast<double>(k) * spectra.bin_Hz >= from_Hz) square += power[k];
    }
  }
  return std::sqrt(square);
}

}  // namespace

std::string to_string(ActsWhile acts) {
  return acts == ActsWhile::sliding ? "while sliding" : acts == ActsWhile::touching ? "in contact" : "always";
}

bool ResidualSpectrum::peaks_matter() const { return !peaks.empty() && share > least_peak_share; }

bool ResidualSpectrum::far_above_noise() const { return raw_N > far_above * null_N; }

std::vector<SpectralPeak> find_peaks(const DetectorSide& side, const Model& model, double from_Hz) {
  const auto sight = look_at(side, model);
  return sight ? peaks_of(*sight, side, model, from_Hz) : std::vector<SpectralPeak>{};
}

ResidualSpectrum residual_spectrum(const DetectorSide& train, const DetectorSide& holdout, const Model& model,
                                   double window_s) {
  ResidualSpectrum spectrum;
  spectrum.from_Hz = 0.5 / window_s;
  const auto sight = look_at(holdout, model);
  if (!sight) return spectrum;
  spectrum.to_Hz = 0.5 / sight->step_s;
  spectrum.raw_N = rms_above_N(sight->residual, sight->step_s, spectrum.from_Hz);
  // Of a law that follows the speed the noise of the tracker is mostly here: that of the recorded positions.
  for (const auto* simulated : {&sight->nulls, &sight->replicas}) {
    for (const Axes& null : *simulated)
      spectrum.null_N = std::max(spectrum.null_N, rms_above_N(null, sight->step_s, spectrum.from_Hz));
  }
  spectrum.peaks = peaks_of(*sight, holdout, model, spectrum.from_Hz);
  if (train.recording != holdout.recording && !spectrum.peaks.empty()) {
    const auto others = find_peaks(train, model, spectrum.from_Hz);
    std::erase_if(spectrum.peaks, [&](const SpectralPeak& peak) {
      return std::none_of(others.begin(), others.end(), [&](const SpectralPeak& other) {
        const double apart_Hz = std::max({peak.width_Hz, other.width_Hz, mains_tolerance * peak.frequency_Hz});
        return std::abs(peak.frequency_Hz - other.frequency_Hz) <= apart_Hz;
      });
    });
  }
  for (const SpectralPeak& peak : spectrum.peaks) spectrum.share += peak.rms_N * peak.rms_N;
  spectrum.share /= std::max(sight->square_N2, std::numeric_limits<double>::min());
  return spectrum;
}

std::string describe(const std::vector<SpectralPeak>& peaks) {
  std::vector<std::string> said;
  for (const SpectralPeak& peak : peaks) {
    const std::string when = peak.acts == ActsWhile::touching ? " in contact" : "";
    said.push_back(fmt::format("{} of {:.4g} Hz{} ({:.2g} N RMS)", peak.name, peak.frequency_Hz, when, peak.rms_N));
  }
  return fmt::format("{}", fmt::join(said, ", "));
}

}  // namespace touchstone::discrepancy
