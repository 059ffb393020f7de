#include "harness/discrepancy/tracker_spectrum.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "harness/discrepancy/welch.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
namespace {

constexpr double segment_s = 1.0;
constexpr std::size_t least_segments = 10;
constexpr double lowest_Hz = 2.0;  // below, a hand's motion has no slope of its own
// A hand moves by itself at up to some 5 to 10 Hz (Brooks, Telerobotic response requirements, 1990), which ends like a
// shelf does: a corner below is no tracker's, whose rate is four or five times it.
constexpr double lowest_corner_Hz = 8.0;
constexpr int difference_order = 2;
constexpr double level = 0.001;

// The spectrum as the fit sees it: means of log S over bands of a semitone, so that all octaves count alike.
struct Bands {
  std::vector<double> f_Hz, log_S, count;
  double independent = 0.0;  // bins of the periodogram that vary by themselves
  double nyquist_Hz = 0.0;
};

// The median over segments of one axis, per bin [m^2/Hz]. The periodogram of a segment is exponentially distributed
// about the spectrum, whose median is ln 2 of its mean. Of third differences, and corrected for them: as they stand,
// the taper's side lobes would carry the motion's low frequencies over the noise (prewhitening: Percival and Walden,
// Spectral Analysis for Physical Applications, 1993, section 6.5).
std::vector<double> median_spectrum(std::vector<double> series, double step_s, std::size_t length) {
  for (int order = 0; order < difference_order; ++order) {
    for (std::size_t i = series.size() - 1; i > 0; --i) series[i] -= series[i - 1];
    series.erase(series.begin());
  }
  Axes piece;
  std::vector<std::vector<double>> powers(length / 2 + 1);
  for (std::size_t begin = 0; begin + length <= series.size(); begin += length / 2) {
    const auto first = series.begin() + static_cast<std::ptrdiff_t>(begin);
    piece.fill(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(length)));
    const Spectra one = welch(piece, step_s, length);
    for (std::size_t k = 0; k < powers.size(); ++k) powers[k].push_back(one.power_N2[0][k] / one.bin_Hz);
  }
  std::vector<double> spectrum;
  for (std::size_t k = 0; k < powers.size(); ++k) {
    // What a difference makes of the power: |1 - exp(-i w)|^2 = (2 sin(w / 2))^2.
    const double w = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(length);
    const double gain = std::pow(2.0 * std::sin(0.5 * w), 2 * difference_order);
    spectrum.push_back(k == 0 ? 0.0 : stats::median(std::move(powers[k])) / (std::numbers::ln2 * gain));
  }
  return spectrum;
}

Bands bands_of(const MotionColumns& motion) {
  Bands bands;
  const double step_s = median_step_s(motion.t_s);
  const std::size_t length = fast_length(static_cast<std::size_t>(std::max(2.0, segment_s / step_s)));
  const Axes axes = even(motion.t_s, motion.p_W_m, step_s);
  if (length < 16 || axes[0].size() < (least_segments + 1) * length / 2) return bands;
  std::vector<std::vector<double>> spectra;
  for (const std::vector<double>& axis : axes) {
    const bool still = std::ranges::all_of(axis, [&](double x) { return x == axis.front(); });
    if (!still) spectra.push_back(median_spectrum(axis, step_s, length));
  }
  if (spectra.empty()) return bands;
  const double bin_Hz = 1.0 / (static_cast<double>(length) * step_s);
  bands.nyquist_Hz = 0.5 / step_s;
  constexpr double semitone = 1.0594630943592953;  // 2^(1/12)
  // The last bins are left out: what was interpolated has a zero there.
  for (std::size_t k = static_cast<std::size_t>(std::ceil(lowest_Hz / bin_Hz)); k < 9 * length / 20;) {
    double sum = 0.0, count = 0.0, f_sum = 0.0;
    const double end_Hz = static_cast<double>(k) * bin_Hz * semitone;
    do {
      double S = 0.0;
      for (const auto& spectrum : spectra) S += spectrum[k] / static_cast<double>(spectra.size());
      if (S > 0.0) {
        sum += std::log(S);
        f_sum += static_cast<double>(k) * bin_Hz;
        count += 1.0;
      }
      ++k;
    } while (k < 9 * length / 20 && static_cast<double>(k) * bin_Hz < end_Hz);
    if (count == 0.0) continue;
    bands.f_Hz.push_back(f_sum / count);
    bands.log_S.push_back(sum / count);
    bands.count.push_back(count);
    // A Hann taper correlates the powers of neighbouring bins by 4/9, of those beyond by 1/36.
    bands.independent += count / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0));
  }
  return bands;
}

// Logarithms, so that no part can become negative. Each shelf has three parameters more.
enum Parameter : std::size_t { log_A, exponent, per_Hz, log_w, first_shelf };
enum OfShelf : std::size_t { log_N, log_corner, order, shelf_parameters };
constexpr std::size_t most_shelves = 2;
using Parameters = std::vector<double>;

double motion_of(const double* u, double f_Hz) {
  return std::exp(u[log_A] - u[exponent] * std::log(f_Hz / lowest_Hz) - u[per_Hz] * (f_Hz - lowest_Hz));
}

double shelf_of(const double* shelf, double f_Hz) {
  return std::exp(shelf[log_N]) / (1.0 + std::pow(f_Hz / std::exp(shelf[log_corner]), 2.0 * shelf[order]));
}

struct Misfit {
  const Bands& bands;
  std::size_t shelves;
  bool operator()(double const* const* u, double* left) const {
    for (std::size_t i = 0; i < bands.f_Hz.size(); ++i) {
      const double f = bands.f_Hz[i];
      double S = motion_of(u[0], f) + std::exp(u[0][log_w]);
      for (std::size_t k = 0; k < shelves; ++k) S += shelf_of(u[0] + first_shelf + k * shelf_parameters, f);
      left[i] = std::sqrt(bands.count[i]) * (bands.log_S[i] - std::log(S));
    }
    return true;
  }
};

// The sum of squares; `u` is the start and the answer.
double fit(const Bands& bands, Parameters& u) {
  const std::size_t shelves = (u.size() - first_shelf) / shelf_parameters;
  auto* const cost = new ceres::DynamicNumericDiffCostFunction<Misfit>(new Misfit{bands, shelves});
  cost->AddParameterBlock(static_cast<int>(u.size()));
  cost->SetNumResiduals(static_cast<int>(bands.f_Hz.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, u.data());
  const auto bound = [&](std::size_t k, double low, double high) {
    u[k] = std::clamp(u[k], low, high);
    problem.SetParameterLowerBound(u.data(), static_cast<int>(k), low);
    problem.SetParameterUpperBound(u.data(), static_cast<int>(k), high);
  };
  // No part is a thousand times (exp(7)) what was ever seen, or a thousandth of the least.
  const double least = *std::ranges::min_element(bands.log_S) - 7.0;
  const double most = *std::ranges::max_element(bands.log_S) + 7.0;
  bound(log_A, least, most);
  bound(exponent, 0.0, 16.0);
  bound(per_Hz, 0.0, 5.0);
  bound(log_w, least, most);
  for (std::size_t k = first_shelf; k < u.size(); k += shelf_parameters) {
    bound(k + log_N, least, most);
    bound(k + log_corner, std::log(lowest_corner_Hz), std::log(0.8 * bands.nyquist_Hz));
    bound(k + order, 1.0, 40.0);
  }
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return 2.0 * summary.final_cost;
}

struct Fitted {
  Parameters u;
  double left = 0.0;
};

// With one shelf more than `fewer`. Corners are tried an octave and a half apart: from each the fit finds the shelf
// that ends about there.
Fitted one_more(const Bands& bands, const Fitted& fewer) {
  Fitted best = fewer;
  for (double corner_Hz = lowest_corner_Hz; corner_Hz < 0.8 * bands.nyquist_Hz; corner_Hz *= std::numbers::sqrt2) {
    const auto below = std::ranges::lower_bound(bands.f_Hz, corner_Hz) - bands.f_Hz.begin();
    const auto place = std::min(static_cast<std::size_t>(below), bands.f_Hz.size() - 1);
    // From the motion as it was found without this shelf, which may have taken the shelf's place, and from a steep one.
    for (const bool steep : {false, true}) {
      Fitted more = fewer;
      if (steep) {
        more.u[exponent] = 8.0;
        more.u[per_Hz] = 0.0;
      }
      more.u.insert(more.u.end(), {bands.log_S[place], std::log(corner_Hz), 4.0});
      more.left = fit(bands, more.u);
      if (more.left < best.left) best = std::move(more);
    }
  }
  return best;
}

// Whether the parameters more gain more than noise: F of the two sums of squares.
bool gains(const Bands& bands, const Fitted& fewer, const Fitted& more) {
  const auto added = static_cast<double>(more.u.size() - fewer.u.size());
  const double degrees = bands.independent - static_cast<double>(more.u.size());
  if (!(added > 0.0) || !(degrees > 0.0) || !(more.left < fewer.left)) return false;
  return stats::f_tail((fewer.left - more.left) / added / (more.left / degrees), added, degrees) < level;
}

}  // namespace

std::optional<TrackerNoise> tracker_noise(const MotionColumns& motion) {
  if (motion.size() < 2) return std::nullopt;
  const Bands bands = bands_of(motion);
  if (bands.f_Hz.size() <= first_shelf + most_shelves * shelf_parameters) return std::nullopt;
  const double floor = *std::ranges::min_element(bands.log_S);
  Fitted best{{bands.log_S.front(), 4.0, 0.1, floor}, 0.0};
  best.left = fit(bands, best.u);
  // Two, because the images of an interpolation are a second one.
  for (std::size_t k = 0; k < most_shelves; ++k) {
    Fitted more = one_more(bands, best);
    if (!gains(bands, best, more)) break;
    best = std::move(more);
  }
  // The largest that is above the floor and, where it ends, above the motion: else it is a bend of one of them.
  double shelf = 0.0, corner_Hz = 0.0;
  for (std::size_t k = first_shelf; k < best.u.size(); k += shelf_parameters) {
    const double N = std::exp(best.u[k + log_N]);
    const double f_Hz = std::exp(best.u[k + log_corner]);
    const bool ends_inside = f_Hz > 1.01 * lowest_corner_Hz && f_Hz < 0.79 * bands.nyquist_Hz;
    const bool stands_out = N > 2.0 * std::exp(best.u[log_w]) && 0.5 * N > motion_of(best.u.data(), f_Hz);
    if (!ends_inside || !stands_out || !(N > shelf)) continue;
    shelf = N;
    corner_Hz = f_Hz;
  }
  if (!(shelf > 0.0)) return std::nullopt;
  TrackerNoise noise;
  noise.corner_Hz = corner_Hz;
  // with_position_noise() low-passes by 1 / (1 + (f / c)^4) at c = rate / 4, whose square is a half at this share of c.
  const double half_of_c = std::pow(std::numbers::sqrt2 - 1.0, 0.25);
  noise.position_rate_Hz = 4.0 * corner_Hz / half_of_c;
  // White samples of deviation s at that rate have the one-sided density 2 s^2 / rate.
  noise.position_noise_m = std::sqrt(0.5 * shelf * noise.position_rate_Hz);
  return noise;
}

}  // namespace touchstone::discrepancy
