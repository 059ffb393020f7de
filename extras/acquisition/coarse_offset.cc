// The first of the steps: everything that the force does fast against everything that the motion does.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string_view>
#include <unsupported/Eigen/FFT>

#include "clock_parts.h"
#include "harness/base/error.h"
#include "harness/stats/quantile.h"
#include "smoothing.h"

namespace touchstone::acquisition {
namespace {

constexpr double block_s = 0.01;       // medians of blocks first: a running median over all samples would take long
constexpr double slow_window_s = 1.5;  // more than two taps' worth
// A peak this near to the highest is the same match: a tap's correlation is as wide as the tap.
constexpr double same_match_s = 0.25;
// A second match is as good as the first from here on: with n taps in an even rhythm the next one over has n - 1 of
// n, and 0.75 for the four that the guide asks for at one end.
constexpr double rival_share = 0.75;
// Of the correlation's own scatter over all offsets. A maximum over ten thousand normal values reaches 3.9.
constexpr double clear_peak = 6.0;

Vec3 middle_of(const std::vector<Vec3>& v, std::size_t first, std::size_t last) {
  Vec3 median;
  std::vector<double> component(last - first);
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = first; i < last; ++i) component[i - first] = v[i][k];
    median[k] = stats::upper_median(component);
  }
  return median;
}

// Mean of the values in every cell of an even grid; zero mean in all; empty cells are zero.
std::vector<double> on_grid(const std::vector<double>& t, const std::vector<double>& values, double start, double cell,
                            std::size_t size) {
  std::vector<double> sum(size, 0.0), count(size, 0.0);
  double mean = 0.0, filled = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const auto k = std::min(size - 1, static_cast<std::size_t>((t[i] - start) / cell));
    sum[k] += values[i], count[k] += 1.0;
  }
  for (std::size_t k = 0; k < size; ++k) {
    if (count[k] > 0.0) sum[k] /= count[k], mean += sum[k], filled += 1.0;
  }
  for (std::size_t k = 0; k < size; ++k) sum[k] = count[k] > 0.0 ? sum[k] - mean / filled : 0.0;
  return sum;
}

// Circular cross-correlation of the force's cells with the motion's, of which those from `first` to `last` count.
std::vector<double> correlation_of(const std::vector<double>& force, const std::vector<double>& motion,
                                   std::size_t first, std::size_t last) {
  std::vector<double> wide(force.size(), 0.0);
  for (std::size_t k = first; k < last; ++k) wide[k] = motion[k / 2];
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> fa, fb;
  fft.fwd(fa, force);
  fft.fwd(fb, wide);
  for (std::size_t k = 0; k < fa.size(); ++k) fa[k] *= std::conj(fb[k]);
  std::vector<double> match;
  fft.inv(match, fa);
  return match;
}

// What a match must exceed to be more than chance.
double chance_of(const std::vector<double>& match) {
  std::vector<double> sizes;
  for (const double m : match) {
    if (m != 0.0) sizes.push_back(std::abs(m));
  }
  return clear_peak * (sizes.empty() ? 0.0 : stats::normal_sigma_per_median * stats::upper_median(std::move(sizes)));
}

std::size_t best_of(const std::vector<double>& match) {
  return static_cast<std::size_t>(std::distance(match.begin(), std::ranges::max_element(match)));
}

// The highest value within a tap's width of an index.
double value_near(const std::vector<double>& match, std::size_t index, double cell_s) {
  const std::size_t n = match.size(), reach = std::min(n / 2, static_cast<std::size_t>(same_match_s / cell_s));
  double highest = match[index];
  for (std::size_t k = 0; k <= 2 * reach; ++k) highest = std::max(highest, match[(index + n - reach + k) % n]);
  return highest;
}

}  // namespace

std::string missing_in(const std::vector<double>& t_s, std::string_view what) {
  constexpr double several = 2.5, worth_saying = 0.01;  // intervals; share of the time
  const double interval_s = sample_interval_s(t_s);
  std::size_t gaps = 0;
  double longest_s = 0.0, missing_s = 0.0;
  for (std::size_t i = 1; i < t_s.size(); ++i) {
    const double step_s = t_s[i] - t_s[i - 1];
    if (step_s < several * interval_s) continue;
    ++gaps;
    longest_s = std::max(longest_s, step_s);
    missing_s += step_s - interval_s;
  }
  if (missing_s < worth_saying * (t_s.back() - t_s.front())) return {};
  return fmt::format(". In the {}, {:.2g} s are missing in {} gaps (the longest {:.3g} s): samples were lost", what,
                     missing_s, gaps, longest_s);
}

std::vector<Vec3> without_slow_part(const std::vector<double>& t_s, const std::vector<Vec3>& force_N) {
  std::vector<double> block_t;
  std::vector<Vec3> block_median;
  for (std::size_t first = 0, last = 0; first < t_s.size(); first = last) {
    while (last < t_s.size() && (last == first || t_s[last] < t_s[first] + block_s)) ++last;
    block_t.push_back(0.5 * (t_s[first] + t_s[last - 1]));
    block_median.push_back(middle_of(force_N, first, last));
  }
  std::vector<Vec3> slow;
  for (std::size_t i = 0, first = 0, last = 0; i < block_t.size(); ++i) {
    while (block_t[first] < block_t[i] - 0.5 * slow_window_s) ++first;
    while (last < block_t.size() && block_t[last] <= block_t[i] + 0.5 * slow_window_s) ++last;
    slow.push_back(middle_of(block_median, first, last));
  }
  std::vector<Vec3> quick;
  quick.reserve(t_s.size());
  for (std::size_t i = 0, right = 0; i < t_s.size(); ++i) {
    while (right + 1 < block_t.size() && block_t[right] < t_s[i]) ++right;
    const std::size_t left = right > 0 ? right - 1 : 0;
    const double span = block_t[right] - block_t[left];
    const double share = span > 0.0 ? std::clamp((t_s[i] - block_t[left]) / span, 0.0, 1.0) : 0.0;
    quick.emplace_back(force_N[i] - slow[left] - share * (slow[right] - slow[left]));
  }
  return quick;
}

double coarse_offset(const std::vector<double>& t_force_s, const std::vector<Vec3>& quick_force_N,
                     const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                     const std::string& source) {
  if (t_force_s.size() < 10 || t_motion_s.size() < 10)
    throw BadData(fmt::format("{}: {} samples of force and {} of motion are too few to align; record at least the taps",
                              source, t_force_s.size(), t_motion_s.size()));
  // Upward acceleration over two samples to either side: what a push by the surface does to the tip.
  const double interval = sample_interval_s(t_motion_s), cell = 0.5 * interval;
  std::vector<double> t_bend, bend;
  for (std::size_t i = 2; i + 2 < t_motion_s.size(); ++i) {
    const double before = t_motion_s[i] - t_motion_s[i - 2], after = t_motion_s[i + 2] - t_motion_s[i];
    if (before > 6 * interval || after > 6 * interval) continue;  // a gap
    t_bend.push_back(t_motion_s[i]);
    bend.push_back((height_m[i + 2] - height_m[i]) / after - (height_m[i] - height_m[i - 2]) / before);
  }
  std::vector<double> push;
  push.reserve(quick_force_N.size());
  // The root, so that one hard tap does not weigh more than all others together.
  for (const Vec3& f : quick_force_N) push.push_back(std::sqrt(f.norm()));
  for (double& b : bend) b = std::copysign(std::sqrt(std::abs(b)), b);
  if (t_bend.empty() || *std::max_element(bend.begin(), bend.end()) <= 0.0) {
    throw BadData(fmt::format(
        "{}: the motion has no abrupt stops along /clocks/tap_normal_W that could be the taps of the force; check that "
        "direction, and that the tracker saw the probe while it tapped",
        source));
  }
  const double force_span = t_force_s.back() - t_force_s.front(), motion_span = t_bend.back() - t_bend.front();
  const auto force_cells = static_cast<std::size_t>(force_span / cell) + 1,
             motion_cells = static_cast<std::size_t>(motion_span / cell) + 1;
  std::size_t size = 1;
  while (size < force_cells + motion_cells) size *= 2;
  std::vector<double> a = on_grid(t_force_s, push, t_force_s.front(), cell, force_cells);
  // The motion has one value per two cells and both get it: it appears one cell late, which is put right at the end.
  const std::vector<double> b = on_grid(t_bend, bend, t_bend.front() - cell, 2 * cell, motion_cells / 2 + 2);
  a.resize(size, 0.0);
  const std::vector<double> match = correlation_of(a, b, 0, motion_cells);
  // match[k] belongs to a lag of k cells, the upper half to negative ones.
  const auto lag_of = [&](std::size_t k) {
    return k < force_cells ? static_cast<double>(k) : static_cast<double>(k) - static_cast<double>(size);
  };
  const std::size_t best = best_of(match);
  const double chance = chance_of(match);
  const double origin = t_force_s.front() - t_bend.front();
  if (!(match[best] > chance)) {
    throw BadData(fmt::format(
        "{}: force and motion do not match at any offset (best correlation {:.1f} times its scatter, {} needed); were "
        "both recorded at the same time, with taps on a hard surface along /clocks/tap_normal_W? Or give the offset of "
        "the clocks (/clocks/offset_s){}{}",
        source, chance > 0.0 ? clear_peak * match[best] / chance : 0.0, clear_peak, missing_in(t_force_s, "force"),
        missing_in(t_motion_s, "motion")));
  }
  const auto offset_of = [&](std::size_t lag) { return origin + (lag_of(lag) + 1.0) * cell; };
  // If each half of the motion matches somewhere, and neither where the other one does, no rhythm is to blame. Halves
  // that lie farther apart than a quarter of the session match other taps than their own.
  const auto early = correlation_of(a, b, 0, motion_cells / 2),
             late = correlation_of(a, b, motion_cells / 2, motion_cells);
  const std::size_t best_early = best_of(early), best_late = best_of(late);
  const double step_s = std::abs(lag_of(best_early) - lag_of(best_late)) * cell;
  if (step_s > same_match_s && step_s < 0.25 * motion_span && early[best_early] > chance_of(early) &&
      late[best_late] > chance_of(late) && value_near(early, best_late, cell) < rival_share * early[best_early] &&
      value_near(late, best_early, cell) < rival_share * late[best_late]) {
    throw BadData(fmt::format(
        "{}: the first half matches at an offset of {:.3f} s and the second at {:.3f} s: between them a clock was set, "
        "or samples were lost whose times are counted, not measured; record again with time stamps{}{}",
        source, offset_of(best_early), offset_of(best_late), missing_in(t_force_s, "force"),
        missing_in(t_motion_s, "motion")));
  }
  for (std::size_t k = 0; k < size; ++k) {
    if (std::abs(lag_of(k) - lag_of(best)) * cell > same_match_s && match[k] > rival_share * match[best]) {
      throw BadData(fmt::format(
          "{}: force and motion match at an offset of {:.3f} s and {:.0f} % as well at {:.3f} s; tap in an uneven "
          "rhythm, so that the pattern fits in one way only, or give the offset of the clocks (/clocks/offset_s){}{}",
          source, offset_of(best), 100 * match[k] / match[best], offset_of(k), missing_in(t_force_s, "force"),
          missing_in(t_motion_s, "motion")));
    }
  }
  // A parabola through the peak.
  const double left = match[(best + size - 1) % size], right = match[(best + 1) % size];
  const double curve = left - 2 * match[best] + right;
  const double part = curve < 0.0 ? std::clamp(0.5 * (left - right) / curve, -1.0, 1.0) : 0.0;
  return origin + (lag_of(best) + part + 1.0) * cell;
}

}  // namespace touchstone::acquisition
