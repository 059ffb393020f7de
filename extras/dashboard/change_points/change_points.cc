#include "change_points/change_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "change_points/energy.h"
#include "change_points/staircase.h"
#include "change_points/trend.h"
#include "change_points/two_sample.h"
#include "harness/stats/quantile.h"

namespace touchstone::change_points {
namespace {

constexpr double builds_per_year = 365.0;
// A drift of a size that matters has a small p after a few months in any case; a step in a short history has not.
constexpr double share_of_drifts = 0.1;
// A stretch without a change is looked at over at most two years.
constexpr std::size_t longest_stretch = 730;
constexpr std::size_t kept_of_longest = 365;
// How many values after a change are compared with those before it: what lies between two of these adds little, and
// each costs its share of the rate. Three to the factor two, rounded.
constexpr std::array<std::size_t, 26> widths{1,  2,  3,  4,  5,   6,   8,   10,  13,  16,  20,  25,  32,
                                             40, 51, 64, 81, 102, 128, 161, 203, 256, 323, 406, 512, 645};
// Beside all values since the last change, so many before the index are compared with those after it: earlier changes
// that are not found yet would hide a later one. Half of the level goes to all values, the rest to these in equal
// parts.
constexpr std::array<std::size_t, 4> reaches{10, 20, 40, 80};

using Values = std::span<const double>;

double mean_of_stretch(Values values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double squares_about_mean(Values values) {
  const double mean = mean_of_stretch(values);
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [&](double sum, double v) { return sum + (v - mean) * (v - mean); });
}

std::size_t widths_from(std::size_t smallest) {
  return static_cast<std::size_t>(std::ranges::count_if(widths, [&](std::size_t w) { return w >= smallest; }));
}

// The largest of the widths that is not above this one, which is at least 1.
std::size_t width_below(std::size_t width) { return *(std::ranges::upper_bound(widths, width) - 1); }

struct Candidate {
  std::size_t start = 0;
  std::size_t index = 0;
  std::size_t end = 0;
};

// Among all pairs, the one of smallest p by the plain t test, with the `reach` values before the index on the left:
// sums make every pair cost the same.
Candidate smallest_p_split(Values values, std::size_t smallest, std::size_t reach) {
  std::vector<double> sums(values.size() + 1, 0.0);
  std::vector<double> squares(values.size() + 1, 0.0);
  const double center = mean_of_stretch(values);  // keeps the squares from cancelling
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i] - center;
    sums[i + 1] = sums[i] + value;
    squares[i + 1] = squares[i] + value * value;
  }
  Candidate best;
  double largest = 0.0;
  for (std::size_t index = smallest; index + smallest <= values.size(); ++index) {
    const std::size_t start = index > reach ? index - reach : 0;
    const auto n = static_cast<double>(index - start);
    const double left = (sums[index] - sums[start]) / n;
    for (const std::size_t width : widths) {
      const std::size_t end = index + width;
      if (width < smallest || end > values.size()) continue;
      const auto m = static_cast<double>(width);
      const double right = (sums[end] - sums[index]) / m;
      const double within = squares[end] - squares[start] - n * left * left - m * right * right;
      const double between = (right - left) * (right - left) * n * m / (n + m);
      // The likelihood ratio orders pairs of different length nearly as p does.
      const double gain = within > 0.0 ? (n + m) * std::log1p(between / within) : 0.0;
      if (gain > largest) {
        largest = gain;
        best = {start, index, end};
      }
    }
  }
  return best;
}

// Where a step from the level before `index` to that after it fits best: least squares. What lies farther than three
// robust standard deviations from its level counts as if it lay there, so that an outlier beside a step does not move
// it.
std::size_t best_place(Values values, std::size_t index, std::size_t smallest) {
  constexpr double deviations = 3.0;
  const auto before = values.first(index);
  const auto after = values.subspan(index);
  double left = stats::median({before.begin(), before.end()});
  double right = stats::median({after.begin(), after.end()});
  std::vector<double> residuals;
  for (std::size_t i = 0; i < values.size(); ++i) residuals.push_back(values[i] - (i < index ? left : right));
  double most = deviations * stats::median_absolute_deviation(residuals);
  if (most == 0.0) most = std::numeric_limits<double>::infinity();
  const auto level = [&](Values side, double middle) {
    double sum = 0.0;
    for (const double value : side) sum += std::clamp(value - middle, -most, most);
    return middle + sum / static_cast<double>(side.size());
  };
  left = level(before, left);
  right = level(after, right);
  const auto squares = [&](double residual) { return std::min(residual * residual, most * most); };
  // What it saves to count the values before a place to the left.
  double saved = 0.0;
  double largest = -std::numeric_limits<double>::infinity();
  std::size_t best = index;
  for (std::size_t i = 0; i + smallest <= values.size(); ++i) {
    if (i >= smallest && saved > largest) largest = saved, best = i;
    saved += squares(values[i] - right) - squares(values[i] - left);
  }
  return best;
}

class Search {
 public:
  Search(Values values, const ChangeOptions& options)
      : values_(values.begin(), values.end()),
        options_(options),
        level_((1.0 - share_of_drifts) * options.false_alarms_per_year /
               (builds_per_year * static_cast<double>(widths_from(options.outliers + 1)))),
        trend_level_(share_of_drifts * options.false_alarms_per_year / builds_per_year) {
    double largest = 0.0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    constexpr double last_bits = 1e-13;
    rounding_ = std::max(last_bits * largest, options.smallest_absolute);
  }

  ChangeReport run() {
    ChangeReport report;
    report.exact = is_exact();
    if (report.exact) {
      exact_steps(report);
    } else {
      stretch(0, values_.size(), report);
      merge(report);
    }
    std::erase_if(report.changes, [&](const Change& change) { return !matters(change.before, change.after); });
    levels(report);
    return report;
  }

 private:
  [[nodiscard]] Values part(std::size_t first, std::size_t end) const {
    return Values(values_).subspan(first, end - first);
  }

  [[nodiscard]] bool matters(double before, double after) const {
    return std::abs(after - before) >
           std::max(options_.smallest_absolute, options_.smallest_relative * std::abs(before));
  }

  [[nodiscard]] bool is_exact() const {
    constexpr std::size_t enough = 8;
    if (values_.size() < enough) return false;
    std::size_t differing = 0;
    for (std::size_t i = 1; i < values_.size(); ++i)
      differing += std::abs(values_[i] - values_[i - 1]) > rounding_ ? 1 : 0;
    return 8 * differing <= values_.size();
  }

  void exact_steps(ChangeReport& report) const {
    for (std::size_t i = 1; i < values_.size(); ++i) {
      if (matters(values_[i - 1], values_[i]))
        report.changes.push_back({ChangeKind::step, i, i, i, values_[i - 1], values_[i], 0.0});
    }
  }

  [[nodiscard]] TwoSample test(std::size_t first, std::size_t index, std::size_t end) const {
    return pooled_t_test_without(part(first, index), part(index, end), options_.outliers, rounding_);
  }

  // The best of the candidates in [first, end), if it passes; 0 if none does.
  [[nodiscard]] std::size_t find_step(std::size_t first, std::size_t end) const {
    const std::size_t smallest = options_.outliers + 1;
    if (end - first < 2 * smallest) return 0;
    const Values values = part(first, end);
    double best = 1.0;
    Candidate found;
    const auto consider = [&](const Candidate& candidate, double level) {
      if (candidate.index == 0) return;
      const double p = test(first + candidate.start, first + candidate.index, first + candidate.end).p / level;
      if (p <= best) {
        best = p;
        found = candidate;
      }
    };
    const EnergySplit energy = largest_energy_split(values, smallest);
    if (energy.index != 0)
      consider({0, energy.index, energy.index + width_below(energy.end - energy.index)}, 0.5 * level_);
    consider(smallest_p_split(values, smallest, values.size()), 0.5 * level_);
    for (const std::size_t reach : reaches) {
      if (reach < values.size())
        consider(smallest_p_split(values, smallest, reach), 0.5 * level_ / static_cast<double>(reaches.size()));
    }
    if (found.index == 0) return 0;
    // The widths decide that there is a step; all places within the pair are asked where.
    const Values pair = values.subspan(found.start, found.end - found.start);
    return first + found.start + best_place(pair, found.index - found.start, smallest);
  }

  // Schwarz's criterion, without what all models of n values share: each parameter beyond those of one level costs log
  // n.
  static double criterion(double squares, std::size_t n, std::size_t more_parameters) {
    const auto values = static_cast<double>(n);
    return values * std::log(std::max(squares, 1e-300)) + static_cast<double>(more_parameters) * std::log(values);
  }

  // One step is held against a line by likelihood, at a limit that one simulated line in twenty passes which rises by
  // four deviations of its noise within fifty builds (steeper ones: fewer). What one step explains worse than a line
  // may still be a staircase: its steps are all searched before it is called a drift, and held against the line by
  // Schwarz's criterion: a line has a slope more than one level, each step its place and a level.
  [[nodiscard]] bool line_is_better(std::size_t first, std::size_t step, std::size_t end) const {
    const double two_levels = squares_about_mean(part(first, step)) + squares_about_mean(part(step, end));
    const double squares_of_line = squares_about_line(part(first, end));
    if (criterion(squares_of_line, end - first, 0) - criterion(two_levels, end - first, 0) > needed_for_one_step)
      return false;
    std::vector<std::size_t> bounds{first, step, end};
    for (std::size_t i = 0; i + 1 < bounds.size();) {
      const std::size_t inner = find_step(bounds[i], bounds[i + 1]);
      if (inner == 0) {
        ++i;
      } else {
        bounds.insert(bounds.begin() + static_cast<std::ptrdiff_t>(i) + 1, inner);
      }
    }
    double stairs = 0.0;
    for (std::size_t i = 0; i + 1 < bounds.size(); ++i) stairs += squares_about_mean(part(bounds[i], bounds[i + 1]));
    return criterion(squares_of_line, end - first, 1) < criterion(stairs, end - first, 2 * (bounds.size() - 2));
  }

  void stretch(std::size_t first, std::size_t end, ChangeReport& report) {
    while (end - first > longest_stretch) {  // whole years, so that a year of builds has one beginning
      const std::size_t next = first + kept_of_longest;
      if (const std::size_t step = find_step(first, first + longest_stretch)) {
        split(first, step, end, report);
        return;
      }
      first = next;
    }
    std::size_t step = find_step(first, end);
    if (end - first >= smallest_drift && (step == 0 || line_is_better(first, step, end))) {
      const Trend trend = find_trend(part(first, end));
      const double to = trend.intercept + trend.slope * static_cast<double>(end - first - 1);
      if (trend.p <= trend_level_ && matters(trend.intercept, to)) {
        step = find_step_beside_line(first, end, trend.slope);
        if (step == 0) {
          explain(trend, first, end, report);
          return;
        }
      }
    }
    if (step != 0) split(first, step, end, report);
  }

  // A stretch that rises or falls: by steps, each of which may be too small to be found alone, or straight.
  void explain(const Trend& trend, std::size_t first, std::size_t end, ChangeReport& report) {
    const std::vector<std::size_t> steps = find_staircase(part(first, end), trend);
    for (const std::size_t step : steps) {
      const std::size_t index = first + step;
      report.changes.push_back({.kind = ChangeKind::step, .index = index, .first = index, .last = index, .p = trend.p});
      of_staircases_.push_back(index);
    }
    if (!steps.empty()) return;
    const double to = trend.intercept + trend.slope * static_cast<double>(end - first - 1);
    report.changes.push_back({ChangeKind::drift, first, first, end - 1, trend.intercept, to, trend.p});
  }

  void split(std::size_t first, std::size_t step, std::size_t end, ChangeReport& report) {
    report.changes.push_back({.kind = ChangeKind::step, .index = step, .first = step, .last = step});
    stretch(first, step, report);
    stretch(step, end, report);
  }

  [[nodiscard]] std::size_t find_step_beside_line(std::size_t first, std::size_t end, double slope) {
    const std::vector<double> kept(part(first, end).begin(), part(first, end).end());
    for (std::size_t i = first; i < end; ++i) values_[i] -= slope * static_cast<double>(i - first);
    const std::size_t step = find_step(first, end);
    std::ranges::copy(kept, values_.begin() + static_cast<std::ptrdiff_t>(first));
    return step;
  }

  // Bottom-up (Fleming et al., Hunter, 2023): a step between neighbouring levels that is none goes, the weakest first.
  void merge(ChangeReport& report) const {
    auto& changes = report.changes;
    std::ranges::sort(changes, {}, [](const Change& c) { return std::pair(c.index, c.kind); });
    while (true) {
      std::size_t weakest = changes.size();
      double largest = level_;
      for (std::size_t i = 0; i < changes.size(); ++i) {
        if (changes[i].kind != ChangeKind::step) continue;
        const auto [first, end] = neighbours(changes, i);
        const TwoSample tested = test(first, changes[i].index, end);
        changes[i].before = tested.before;
        changes[i].after = tested.after;
        // The test of the trend found them together: what each would be alone says nothing.
        if (std::ranges::find(of_staircases_, changes[i].index) != of_staircases_.end()) continue;
        changes[i].p = tested.p;
        if (ends_of_drift(changes, changes[i])) continue;
        if (tested.p > largest) {
          largest = tested.p;
          weakest = i;
        }
      }
      if (weakest == changes.size()) break;
      changes.erase(changes.begin() + static_cast<std::ptrdiff_t>(weakest));
    }
    for (std::size_t i = 0; i < changes.size(); ++i) {
      if (changes[i].kind == ChangeKind::step) place(changes, i);
    }
  }

  // If a drift ends or begins at the step: the step goes from one line to the next, and the means say nothing.
  static bool ends_of_drift(const std::vector<Change>& changes, Change& step) {
    bool found = false;
    for (const Change& change : changes) {
      if (change.kind != ChangeKind::drift) continue;
      if (change.last + 1 == step.index) step.before = change.after;
      if (change.index == step.index) step.after = change.before;
      found = found || change.last + 1 == step.index || change.index == step.index;
    }
    return found;
  }

  // The stretches on both sides of a step: to the neighbouring steps.
  [[nodiscard]] std::pair<std::size_t, std::size_t> neighbours(const std::vector<Change>& changes,
                                                               std::size_t i) const {
    std::size_t first = 0;
    std::size_t end = values_.size();
    for (const Change& other : changes) {
      if (other.kind != ChangeKind::step) continue;
      if (other.index < changes[i].index) first = std::max(first, other.index);
      if (other.index > changes[i].index) end = std::min(end, other.index);
    }
    return {first, end};
  }

  // Places that fit nearly as well: the profile of the likelihood within half the 95 % quantile of chi-squared(1).
  void place(std::vector<Change>& changes, std::size_t i) const {
    const auto [first, end] = neighbours(changes, i);
    const auto n = static_cast<double>(end - first);
    std::vector<double> cost(end - first, 0.0);
    for (std::size_t at = first + 1; at < end; ++at)
      cost[at - first] = squares_about_mean(part(first, at)) + squares_about_mean(part(at, end));
    constexpr double quantile_95 = 3.841458820694124;
    const double most = cost[changes[i].index - first] * std::exp(quantile_95 / n);
    while (changes[i].first > first + 1 && cost[changes[i].first - 1 - first] <= most) --changes[i].first;
    while (changes[i].last + 1 < end && cost[changes[i].last + 1 - first] <= most) ++changes[i].last;
  }

  void levels(ChangeReport& report) const {
    std::size_t first = 0;
    const auto close = [&](std::size_t end) {
      if (end <= first) return;
      const double mean = mean_of_stretch(part(first, end));
      report.levels.push_back({first, end, mean, mean});
      first = end;
    };
    for (const Change& change : report.changes) {
      close(change.index);
      if (change.kind == ChangeKind::drift) {
        report.levels.push_back({change.index, change.last + 1, change.before, change.after});
        first = change.last + 1;
      }
    }
    close(values_.size());
  }

  static constexpr std::size_t smallest_drift = 12;
  static constexpr double needed_for_one_step = 2.0;

  std::vector<double> values_;
  std::vector<std::size_t> of_staircases_;
  ChangeOptions options_;
  double level_;
  double trend_level_;
  double rounding_ = 0.0;
};

}  // namespace

ChangeReport find_changes(std::span<const double> values, const ChangeOptions& options) {
  if (values.empty()) return {};
  return Search(values, options).run();
}

}  // namespace touchstone::change_points
