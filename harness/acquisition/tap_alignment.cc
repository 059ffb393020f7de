#include "harness/acquisition/tap_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/acquisition/hinge.h"
#include "harness/acquisition/smoothing.h"
#include "harness/base/error.h"

namespace touchstone::acquisition {
namespace {

constexpr double ordinary_skew = 100e-6;  // what quartz clocks differ by

struct Pair {
  std::size_t force;
  std::size_t motion;
};

// The pairs that one coarse offset explains, each within `tolerance`.
std::vector<Pair> pairs_at(const std::vector<ForceTap>& taps, const std::vector<MotionStop>& stops, double offset,
                           double tolerance) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    std::size_t best = stops.size();
    double nearest = tolerance;
    for (std::size_t j = 0; j < stops.size(); ++j) {
      const double d = std::abs(taps[i].onset_s - stops[j].stop_s - offset);
      if (d <= nearest) nearest = d, best = j;
    }
    if (best < stops.size()) pairs.push_back({i, best});
  }
  return pairs;
}

// How far the pairs scatter about one offset.
double spread_of(const std::vector<Pair>& pairs, const std::vector<ForceTap>& taps,
                 const std::vector<MotionStop>& stops) {
  double mean = 0.0, square = 0.0;
  const auto n = static_cast<double>(pairs.size());
  for (const Pair& pair : pairs) mean += (taps[pair.force].onset_s - stops[pair.motion].stop_s) / n;
  for (const Pair& pair : pairs) square += std::pow(taps[pair.force].onset_s - stops[pair.motion].stop_s - mean, 2) / n;
  return std::sqrt(square);
}

std::vector<Pair> match(const std::vector<ForceTap>& taps, const std::vector<MotionStop>& stops, double interval,
                        double tolerance, const std::string& source) {
  std::vector<Pair> best;
  double best_offset = 0.0, best_spread = 0.0;
  const auto each_offset = [&](const auto& visit) {
    for (const ForceTap& tap : taps) {
      for (const MotionStop& stop : stops) {
        const double offset = tap.onset_s - stop.stop_s;
        const auto pairs = pairs_at(taps, stops, offset, tolerance);
        if (pairs.size() >= 2) visit(offset, pairs, spread_of(pairs, taps, stops));
      }
    }
  };
  each_offset([&](double offset, const std::vector<Pair>& pairs, double spread) {
    if (pairs.size() > best.size() || (pairs.size() == best.size() && spread < best_spread))
      best = pairs, best_offset = offset, best_spread = spread;
  });
  if (best.size() < 2) {
    throw BadData(fmt::format(
        "{}: {} taps in the force and {} abrupt stops in the motion, but no two of them fit one offset; were both "
        "streams recorded at the same time?",
        source, taps.size(), stops.size()));
  }
  // A rival that explains as many taps, or all but one, and as sharply: the rhythm is the same from both ends.
  const double sharp = 3.0 * std::max(best_spread, 0.3 * interval);
  each_offset([&](double offset, const std::vector<Pair>& pairs, double spread) {
    if (std::abs(offset - best_offset) > 4 * tolerance && pairs.size() >= std::max<std::size_t>(2, best.size() - 1) &&
        spread < sharp) {
      throw BadData(fmt::format(
          "{}: {} taps fit at an offset of {:.3f} s and {} at {:.3f} s; tap in an uneven rhythm, so that the pattern "
          "fits in one way only",
          source, best.size(), best_offset, pairs.size(), offset));
    }
  });
  return best;
}

using Event = ClockAlignment::Event;

struct Line {
  double reference = 0.0, offset = 0.0, skew = 0.0, offset_sigma = 0.0, skew_sigma = 0.0, rms = 0.0;
  bool skew_fitted = false;
};

// Weighted least squares of t_force - t_motion = offset + skew (t_motion - reference); fills the residuals.
Line fit_line(std::vector<Event>& events) {
  Line line;
  const auto n = static_cast<double>(events.size());
  double sum = 0.0;
  for (const Event& e : events) {
    const double weight = 1.0 / (e.sigma_s * e.sigma_s);
    sum += weight;
    line.reference += weight * e.motion_s;
  }
  line.reference /= sum;
  double s_tt = 0.0, s_td = 0.0;
  for (const Event& e : events) {
    const double weight = 1.0 / (e.sigma_s * e.sigma_s), t = e.motion_s - line.reference, d = e.force_s - e.motion_s;
    line.offset += weight * d / sum;
    s_tt += weight * t * t;
    s_td += weight * t * d;
  }
  line.offset_sigma = 1.0 / std::sqrt(sum);
  line.skew_sigma = s_tt > 0.0 ? 1.0 / std::sqrt(s_tt) : ordinary_skew;
  // A skew that the taps tell no better than clocks keep time anyway would only add error.
  line.skew_fitted = events.size() >= 3 && line.skew_sigma < ordinary_skew;
  if (line.skew_fitted) line.skew = s_td / s_tt;
  double chi = 0.0;
  for (Event& e : events) {
    e.residual_s = e.force_s - e.motion_s - line.offset - line.skew * (e.motion_s - line.reference);
    line.rms += e.residual_s * e.residual_s / n;
    chi += std::pow(e.residual_s / e.sigma_s, 2);
  }
  line.rms = std::sqrt(line.rms);
  // Scatter beyond what the single fits promise widens the uncertainty; less scatter does not narrow it.
  const double freedom = n - (line.skew_fitted ? 2 : 1);
  const double widen = freedom > 0 ? std::sqrt(std::max(1.0, chi / freedom)) : 1.0;
  line.offset_sigma *= widen;
  line.skew_sigma = line.skew_fitted ? line.skew_sigma * widen : ordinary_skew;
  return line;
}

// Fits, dropping events that were not the tap's: the worst, while it lies beyond four of its sigmas and 0.3 samples.
Line fit_robustly(std::vector<Event>& events, double interval) {
  Line line = fit_line(events);
  while (events.size() > 3) {
    const auto worst = std::max_element(events.begin(), events.end(), [](const Event& a, const Event& b) {
      return std::abs(a.residual_s) / a.sigma_s < std::abs(b.residual_s) / b.sigma_s;
    });
    if (std::abs(worst->residual_s) < 4.0 * worst->sigma_s || std::abs(worst->residual_s) < 0.3 * interval) break;
    events.erase(worst);
    line = fit_line(events);
  }
  return line;
}

// The motion around a tap, in the direction of time or against it.
struct Excerpt {
  std::vector<double> t_s, height_m;
};

Excerpt excerpt(const std::vector<double>& t_s, const std::vector<double>& height_m, double from_s, double to_s,
                bool backwards) {
  const auto first = std::distance(t_s.begin(), std::lower_bound(t_s.begin(), t_s.end(), from_s));
  const auto last = std::distance(t_s.begin(), std::upper_bound(t_s.begin(), t_s.end(), to_s));
  Excerpt part{{t_s.begin() + first, t_s.begin() + last}, {height_m.begin() + first, height_m.begin() + last}};
  if (backwards) {
    std::reverse(part.t_s.begin(), part.t_s.end());
    std::reverse(part.height_m.begin(), part.height_m.end());
    for (double& t : part.t_s) t = -t;
  }
  return part;
}

}  // namespace

double ClockAlignment::sigma_at(double t_motion_s) const {
  return std::hypot(offset_sigma_s, skew_sigma * (t_motion_s - reference_s));
}

ClockAlignment align_by_taps(const std::vector<double>& t_force_s, const std::vector<double>& normal_force_N,
                             const std::vector<double>& t_motion_s, const std::vector<double>& height_m,
                             const TapOptions& options, const std::string& source) {
  const auto taps = find_force_taps(t_force_s, normal_force_N, options);
  if (taps.empty()) {
    throw BadData(fmt::format(
        "{}: no taps in the force (contacts of {} to {} s); tap the object a few times before and after scanning, or "
        "give the offset of the clocks",
        source, options.shortest_tap_s, options.longest_tap_s));
  }
  const auto stops = find_motion_stops(t_motion_s, height_m, options);
  if (stops.empty())
    throw BadData(
        fmt::format("{}: no abrupt stops in the motion that could be the {} taps of the force", source, taps.size()));
  const double interval = sample_interval_s(t_motion_s);
  const double tolerance = 2.0 * interval + options.largest_skew * (t_motion_s.back() - t_motion_s.front());
  const auto pairs = match(taps, stops, interval, tolerance, source);

  // The force says for how long the tip rests: nine tenths of the tap belong to the level.
  std::vector<Event> onsets, releases;
  double square = 0.0, fitted = 0.0;
  const auto add = [&](std::vector<Event>& events, const MotionStop& stop, double force_s, double force_sigma_s,
                       bool backwards) {
    if (!(stop.height_rms_m > 0.0)) return;
    square += stop.height_rms_m * stop.height_rms_m, fitted += 1.0;
    // For now in units of the height's noise; force_sigma_s joins when that is known.
    events.push_back({force_s, backwards ? -stop.stop_s : stop.stop_s, stop.stop_sigma_s / stop.height_rms_m,
                      force_sigma_s, backwards});
  };
  for (const Pair& pair : pairs) {
    const ForceTap& tap = taps[pair.force];
    const double rest = std::max(0.9 * (tap.release_s - tap.onset_s), 2.5 * interval),
                 guess = stops[pair.motion].stop_s;
    const double leave = guess + tap.release_s - tap.onset_s, margin = options.approach_s + 3 * interval;
    const Excerpt before = excerpt(t_motion_s, height_m, guess - margin, leave, false);
    add(onsets, fit_hinge(before.t_s, before.height_m, guess, guess + rest, options.approach_s), tap.onset_s,
        tap.onset_sigma_s, false);
    const Excerpt after = excerpt(t_motion_s, height_m, guess, leave + margin, true);
    add(releases, fit_hinge(after.t_s, after.height_m, -leave, -leave + rest, options.approach_s), tap.release_s,
        tap.release_sigma_s, true);
  }
  if (onsets.size() < 2)
    throw BadData(fmt::format("{}: fewer than two taps have enough samples of the motion around them", source));
  // The tracker's noise is the same for all taps: a few samples estimate it poorly, all of them together well.
  const double noise = std::sqrt(square / fitted);
  for (auto* events : {&onsets, &releases}) {
    for (Event& e : *events) e.sigma_s = std::hypot(e.sigma_s * noise, e.residual_s);
  }
  ClockAlignment result;
  result.taps = onsets.size();
  result.events = onsets;
  Line line = fit_robustly(result.events, interval);
  if (releases.size() >= 3) {
    auto alone = releases;
    const Line leaving = fit_robustly(alone, interval);
    const double between = leaving.offset + leaving.skew * (line.reference - leaving.reference) - line.offset;
    if (std::abs(between) < 2.0 * std::hypot(line.offset_sigma, leaving.offset_sigma)) {
      result.releases_used = true;
      result.events = onsets;
      result.events.insert(result.events.end(), releases.begin(), releases.end());
      line = fit_robustly(result.events, interval);
    }
  }
  if (std::abs(line.skew) > options.largest_skew) {
    throw BadData(
        fmt::format("{}: the taps give a clock skew of {:.0f} ppm, more than the {:.0f} ppm that clocks differ by; a "
                    "tap was probably "
                    "missed by one of the streams",
                    source, line.skew * 1e6, options.largest_skew * 1e6));
  }
  result.reference_s = line.reference;
  result.offset_s = line.offset;
  result.skew = line.skew;
  result.offset_sigma_s = line.offset_sigma;
  result.skew_sigma = line.skew_sigma;
  result.residual_rms_s = line.rms;
  result.skew_fitted = line.skew_fitted;
  return result;
}

}  // namespace touchstone::acquisition
