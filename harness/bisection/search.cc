#include "harness/bisection/search.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numbers>

#include "harness/stats/quantile.h"

namespace touchstone::bisection {
namespace {

// A change of the metric by less than this share of its value is rounding.
constexpr double rounding = 1e-12;
// So many intervals in a row that all go the same way are drift: k steps make it with k intervals only, and more than
// six culprits between two releases are drift by any name. No commit then holds more than a seventh of it on average.
constexpr std::size_t least_drift_intervals = 7;
// An interval goes a way if its change is so many standard errors of its own. Of noise alone one goes a given way with
// a probability of 0.31, and seven in a row go one of both with less than 2 * 0.31^7 = 0.05 %; an interval of a drift
// that noise hides seldom breaks the row then, and the drift is known before its intervals have all been divided.
constexpr double directed_errors = 0.5;
// Standard errors by which a change that matters stands clear of none (the decision is at half of them).
constexpr double clear_errors = 6.0;
// Ends differ, and excesses within drift are none of it, beyond so many standard errors.
constexpr double significant_errors = 4.0;

// Between two neighbouring measured commits.
struct Interval {
  std::size_t from = 0;
  std::size_t to = 0;
  double change = 0.0;
  double error = 0.0;
  double drift = 0.0;     // of the change, as its neighbours have it
  double scatter = 0.0;   // of what so many commits change about the common rate
  std::size_t peers = 0;  // intervals of the drift
  bool in_drift = false;
  [[nodiscard]] double length() const { return static_cast<double>(to - from); }
  [[nodiscard]] double excess() const { return change - drift; }
};

// Changes per commit, each weighed by the commits that it stands for.
double typical_rate(const std::vector<Interval>& all, std::size_t first, std::size_t last) {
  std::vector<std::pair<double, double>> rates;
  double total = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    rates.emplace_back(all[i].change / all[i].length(), all[i].length());
    total += all[i].length();
  }
  std::ranges::sort(rates);
  double passed = 0.0;
  for (const auto& [rate, weight] : rates) {
    passed += weight;
    if (passed >= 0.5 * total) return rate;
  }
  return 0.0;
}

void mark_drift(std::vector<Interval>& all, std::size_t first, std::size_t last) {
  if (last - first < least_drift_intervals) return;
  const double rate = typical_rate(all, first, last);
  std::vector<double> deviations;
  // Independent commits: the variance grows with their number.
  for (std::size_t i = first; i < last; ++i)
    deviations.push_back(std::abs(all[i].change - rate * all[i].length()) / std::sqrt(all[i].length()));
  // As a standard deviation, of one commit.
  const double scatter = stats::normal_sigma_per_median * stats::upper_median(std::move(deviations));
  for (std::size_t i = first; i < last; ++i) {
    all[i].in_drift = true;
    all[i].drift = rate * all[i].length();
    all[i].scatter = scatter * std::sqrt(all[i].length());
    all[i].peers = last - first;
  }
}

std::vector<Interval> intervals_of(const CommitCurve& curve) {
  const auto positions = curve.measured_positions();
  std::vector<Interval> all;
  for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
    const std::size_t from = positions[i];
    const std::size_t to = positions[i + 1];
    all.push_back({from, to, curve.change(from, to), curve.change_error(from, to)});
  }
  const double tiny = rounding * std::max(std::abs(curve.level(0)), std::abs(curve.level(curve.size() - 1)));
  const auto direction = [&](const Interval& one) {
    if (std::abs(one.change) <= std::max(directed_errors * one.error, tiny)) return 0;
    return one.change > 0.0 ? 1 : -1;
  };
  for (std::size_t first = 0; first < all.size();) {
    const int way = direction(all[first]);
    std::size_t last = first + 1;
    while (last < all.size() && direction(all[last]) == way) ++last;
    if (way != 0) mark_drift(all, first, last);
    first = last;
  }
  return all;
}

struct Scale {
  bool differ = false;
  double change = 0.0;  // between the ends
  double error = 0.0;
  double matters = 0.0;
  std::size_t runs = 1;  // of each commit
};

Scale scale_of(const CommitCurve& curve, const SearchOptions& options) {
  Scale scale;
  const std::size_t last = curve.size() - 1;
  if (!curve.measured(0) || !curve.measured(last)) return scale;
  scale.change = curve.change(0, last);
  scale.error = curve.change_error(0, last);
  const double tiny = rounding * std::max(std::abs(curve.level(0)), std::abs(curve.level(last)));
  const double whole = std::abs(scale.change);
  scale.differ = whole > std::max({significant_errors * scale.error, tiny, options.least_change});
  const double noise = curve.noise();
  // Runs for which the difference of two medians has a clear_errors-th of `size` as its standard error.
  const auto runs_for = [&](double size) {
    const double ratio = clear_errors * noise / size;
    return std::ceil(std::numbers::pi * ratio * ratio);
  };
  scale.matters = std::max(options.least_share * whole, options.least_change);
  const auto most = static_cast<double>(options.most_runs);
  if (noise > 0.0 && runs_for(scale.matters) > most)
    scale.matters = std::min(whole, clear_errors * noise * std::sqrt(std::numbers::pi / most));
  if (noise > 0.0) scale.runs = static_cast<std::size_t>(std::clamp(runs_for(scale.matters), 1.0, most));
  return scale;
}

bool matters(const Interval& one, const Scale& scale) {
  if (std::abs(one.change) <= 0.5 * scale.matters) return false;
  if (!one.in_drift) return true;
  return std::abs(one.excess()) >
         std::max({0.5 * scale.matters, significant_errors * one.error, significant_errors * one.scatter});
}

// Positions within the interval that may still be measured: none between two broken ones once that has been tried a
// few times, since broken commits come in rows.
struct Gap {
  std::size_t from = 0;
  std::size_t to = 0;
  bool works_beside = false;  // one of its ends is measured
  [[nodiscard]] std::size_t inside() const { return to - from - 1; }
};

std::optional<Gap> best_gap(const CommitCurve& curve, std::size_t from, std::size_t to) {
  constexpr std::size_t most_broken = 6;
  std::optional<Gap> best;
  std::size_t broken = 0;
  Gap gap{from, from, true};
  for (std::size_t i = from + 1; i <= to; ++i) {
    if (i < to && !curve.broken(i)) continue;
    gap.to = i;
    gap.works_beside = gap.from == from || i == to;
    const bool better = !best || (gap.works_beside && !best->works_beside) ||
                        (gap.works_beside == best->works_beside && gap.inside() > best->inside());
    if (gap.inside() > 0 && better) best = gap;
    broken += i < to ? 1 : 0;
    gap.from = i;
  }
  if (best && !best->works_beside && broken >= most_broken) best.reset();
  return best;
}

double confidence_of(const Step& step, const Interval& one, const CommitCurve& curve) {
  // Of the larger part of the error: the noise of runs, or the unevenness of the drift.
  const std::size_t freedom = one.scatter > one.error ? one.peers - 1 : curve.degrees_of_freedom();
  if (step.error <= 0.0) return 1.0;
  const double t = std::abs(step.excess) / step.error;
  const boost::math::students_t law(static_cast<double>(std::max<std::size_t>(1, freedom)));
  const double p = 2.0 * boost::math::cdf(boost::math::complement(law, t));
  // Any of the commits could have come out so by noise.
  return std::max(0.0, 1.0 - p * static_cast<double>(curve.size() - 1));
}

std::vector<MeasureRequest> requests_for_ends(const CommitCurve& curve, const SearchOptions& options) {
  const std::size_t last = curve.size() - 1;
  std::vector<MeasureRequest> requests;
  // Two runs that agree to the bit on both ends: the metric has no noise, and one run says all.
  for (const std::size_t end : {std::size_t{0}, last}) {
    if (!curve.broken(end) && curve.runs(end) < 2) requests.push_back({end, 2 - curve.runs(end)});
  }
  if (!requests.empty() || curve.broken(0) || curve.broken(last)) return requests;
  if (curve.noise() <= 0.0) return {};
  const std::size_t wanted = std::max(options.end_runs, scale_of(curve, options).runs);
  for (const std::size_t end : {std::size_t{0}, last}) {
    if (curve.runs(end) < options.end_runs) requests.push_back({end, options.end_runs - curve.runs(end)});
  }
  if (!requests.empty()) return requests;
  for (const std::size_t end : {std::size_t{0}, last}) {
    if (curve.runs(end) < wanted) requests.push_back({end, wanted - curve.runs(end)});
  }
  return requests;
}

// Positions that divide the interval best: one for its middle, more where several are built at once.
void divide(const CommitCurve& curve, const Interval& one, std::size_t parts, std::size_t runs,
            std::vector<MeasureRequest>& requests) {
  const auto gap = best_gap(curve, one.from, one.to);
  if (!gap) return;
  const std::size_t places = std::min(parts, gap->inside());
  for (std::size_t k = 1; k <= places; ++k) {
    const std::size_t position = gap->from + std::max<std::size_t>(1, (gap->to - gap->from) * k / (places + 1));
    const bool there = std::ranges::any_of(requests, [&](const auto& r) { return r.position == position; });
    if (!there) requests.push_back({position, runs});
  }
}

}  // namespace

std::vector<MeasureRequest> next_requests(const CommitCurve& curve, const SearchOptions& options) {
  auto requests = requests_for_ends(curve, options);
  if (!requests.empty() || curve.broken(0) || curve.broken(curve.size() - 1)) return requests;
  const Scale scale = scale_of(curve, options);
  if (!scale.differ) return {};
  std::vector<Interval> open;
  for (const Interval& one : intervals_of(curve)) {
    if (matters(one, scale) && best_gap(curve, one.from, one.to)) open.push_back(one);
  }
  std::ranges::stable_sort(open, [](const Interval& a, const Interval& b) {
    return std::abs(a.in_drift ? a.excess() : a.change) > std::abs(b.in_drift ? b.excess() : b.change);
  });
  if (!open.empty()) {
    const std::size_t most = std::max<std::size_t>(1, options.parallel);
    const std::size_t used = std::min(most, open.size());
    // Workers that have no interval of their own help with the first.
    for (std::size_t i = 0; i < used; ++i) divide(curve, open[i], i == 0 ? most - used + 1 : 1, scale.runs, requests);
    return requests;
  }
  if (curve.noise() <= 0.0) return {};
  // What is to be named is measured as often again, on both sides in turn.
  for (const Step& step : conclude(curve, options).steps) {
    for (const std::size_t side : {step.before, step.at}) {
      const std::size_t wanted = 2 * scale.runs + 2;
      const bool there = std::ranges::any_of(requests, [&](const auto& r) { return r.position == side; });
      if (curve.runs(side) < wanted && !there) requests.push_back({side, wanted - curve.runs(side)});
    }
  }
  return requests;
}

SearchFindings conclude(const CommitCurve& curve, const SearchOptions& options) {
  SearchFindings found;
  const Scale scale = scale_of(curve, options);
  if (!curve.measured(0) || !curve.measured(curve.size() - 1)) return found;
  found.good = curve.level(0);
  found.bad = curve.level(curve.size() - 1);
  found.noise = curve.noise();
  found.end_error = scale.error;
  found.ends_differ = scale.differ;
  found.matters = scale.matters;
  if (!scale.differ) return found;
  // Changes that are not named, from one named step to the next, are drift where they go together somewhere.
  std::vector<Interval> rest;
  double explained = 0.0;
  const auto all = intervals_of(curve);
  for (Interval one : all) {
    if (matters(one, scale) && !best_gap(curve, one.from, one.to)) {
      Step step{one.from, one.to, one.change, one.excess(), std::hypot(one.error, one.in_drift ? one.scatter : 0.0)};
      step.share = step.excess / scale.change;
      step.confidence = confidence_of(step, one, curve);
      explained += step.share;
      found.steps.push_back(step);
      one.change = one.drift;
    }
    rest.push_back(one);
  }
  const double tiny = rounding * std::max(std::abs(found.good), std::abs(found.bad));
  for (std::size_t first = 0; first < rest.size();) {
    const auto goes = [&](const Interval& one) { return std::abs(one.change) > std::max(one.error, tiny); };
    if (!goes(rest[first])) {
      ++first;
      continue;
    }
    std::size_t end = first;
    // A lull of one interval does not end a drift.
    for (std::size_t i = first; i < rest.size() && i <= end + 2; ++i) {
      if (goes(rest[i]) && (rest[i].change > 0.0) == (rest[first].change > 0.0)) end = i;
    }
    Drift drift{rest[first].from, rest[end].to};
    for (std::size_t i = first; i <= end; ++i) {
      drift.change += rest[i].change;
      drift.largest = std::max(drift.largest, std::abs(rest[i].change));
    }
    drift.share = drift.change / scale.change;
    const double error = curve.change_error(drift.first, drift.last);
    if (end > first && std::abs(drift.change) > std::max(0.5 * scale.matters, significant_errors * error)) {
      explained += drift.share;
      found.drifts.push_back(drift);
    }
    first = end + 1;
  }
  found.unexplained_share = 1.0 - explained;
  return found;
}

}  // namespace touchstone::bisection
