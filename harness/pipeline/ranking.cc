#include "harness/pipeline/ranking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/pipeline/block_length.h"
#include "harness/stats/all_pairs.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/series_mean.h"

namespace touchstone::pipeline {
namespace {

constexpr double rounding = 1e-12;  // of a log ratio or share: errors equal but for the order of summation

// Of the level; see ranking.h.
constexpr double share_within_recordings = 1.0 / 3.0;
constexpr double share_over_datasets = 0.8;

// Running sums of the bins of one data set, twice around, so that a circular block is a difference of two.
struct RunningSums {
  std::size_t bins = 0;
  std::vector<std::vector<double>> squares;  // [renderer][2 bins + 1]
  std::vector<double> samples;
};

void check_errors(const std::vector<DatasetErrors>& datasets) {
  if (datasets.empty() || datasets.front().empty()) throw UsageError("a ranking needs a data set and a renderer");
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    const DatasetErrors& errors = datasets[d];
    if (errors.size() != datasets.front().size()) throw UsageError("every data set must have every renderer");
    for (std::size_t r = 0; r < errors.size(); ++r) {
      if (errors[r].samples != errors.front().samples || errors[r].squares_N2.size() != errors[r].samples.size()) {
        throw UsageError(
            fmt::format("data set {}: renderer {} was not judged on the same samples as the others", d, r));
      }
      if (!std::isfinite(errors[r].rms_N())) {
        throw UsageError(fmt::format("data set {}: the errors of renderer {} are no numbers", d, r));
      }
    }
  }
}

RunningSums running_sums(const DatasetErrors& errors) {
  RunningSums out;
  out.bins = errors.front().size();
  out.samples.assign(1, 0.0);
  for (std::size_t i = 0; i < 2 * out.bins; ++i) {
    out.samples.push_back(out.samples.back() + static_cast<double>(errors.front().samples[i % out.bins]));
  }
  for (const BinnedErrors& one : errors) {
    std::vector<double> sums(1, 0.0);
    for (std::size_t i = 0; i < 2 * out.bins; ++i) sums.push_back(sums.back() + one.squares_N2[i % out.bins]);
    out.squares.push_back(std::move(sums));
  }
  return out;
}

// Of log RMS; an error of exactly zero counts as the smallest number there is, so that it is best and not undefined.
double half_log(double squares, double samples) {
  return 0.5 * std::log(std::max(squares / samples, std::numeric_limits<double>::min()));
}

// As long as the difference of any renderer from the mean of all needs.
std::size_t bins_of_a_block(const DatasetErrors& errors) {
  const std::size_t n = errors.front().size();
  std::vector<double> mean(n, 0.0);
  for (const BinnedErrors& one : errors) {
    for (std::size_t i = 0; i < n; ++i) mean[i] += one.squares_N2[i] / static_cast<double>(errors.size());
  }
  std::size_t longest = 1;
  std::vector<double> difference(n);
  for (const BinnedErrors& one : errors) {
    for (std::size_t i = 0; i < n; ++i) difference[i] = one.squares_N2[i] - mean[i];
    longest = std::max(longest, automatic_block_length(difference));
  }
  return longest;
}

// The scores of every renderer on as much of a recording as there is, made of blocks from anywhere on the circle.
std::vector<double> draw(const RunningSums& sums, std::size_t block, Random& random) {
  std::vector<double> squares(sums.squares.size(), 0.0);
  double samples = 0.0;
  const std::size_t count = std::max<std::size_t>(1, (sums.bins + block / 2) / block);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t from = random.below(sums.bins);
    samples += sums.samples[from + block] - sums.samples[from];
    for (std::size_t r = 0; r < squares.size(); ++r)
      squares[r] += sums.squares[r][from + block] - sums.squares[r][from];
  }
  for (double& one : squares) one = half_log(one, samples);
  return squares;
}

// [renderer][draw]
std::vector<std::vector<double>> draw_scores(const std::vector<RunningSums>& sums, const RankingOptions& options,
                                             const Ranking& ranking) {
  std::vector<std::vector<double>> scores(sums.front().squares.size());
  const Random root(options.seed);
  for (std::size_t i = 0; i < options.draws; ++i) {
    Random random = root.stream(i);
    std::vector<double> mean(scores.size(), 0.0);
    for (std::size_t d = 0; d < sums.size(); ++d) {
      const std::size_t chosen = ranking.datasets_resampled ? random.below(sums.size()) : d;
      const std::vector<double> own = draw(sums[chosen], ranking.block_bins[chosen], random);
      for (std::size_t r = 0; r < own.size(); ++r) mean[r] += own[r] / static_cast<double>(sums.size());
    }
    for (std::size_t r = 0; r < mean.size(); ++r) scores[r].push_back(mean[r]);
  }
  return scores;
}

void set_intervals(const std::vector<std::vector<double>>& scores, Ranking& ranking) {
  for (RankedRenderer& one : ranking.order) {
    one.low95 = stats::reaching_quantile(scores[one.renderer], 0.025);
    one.high95 = stats::reaching_quantile(scores[one.renderer], 0.975);
  }
  std::vector<double> ratios;
  for (PairOfRenderers& pair : ranking.pairs) {
    ratios.clear();
    for (std::size_t i = 0; i < scores[pair.better].size(); ++i)
      ratios.push_back(scores[pair.better][i] - scores[pair.other][i]);
    pair.low95 = stats::reaching_quantile(ratios, 0.025);
    pair.high95 = stats::reaching_quantile(ratios, 0.975);
  }
}

double score_on(const RunningSums& sums, std::size_t renderer) {
  return half_log(sums.squares[renderer][sums.bins], sums.samples[sums.bins]);
}

// Student's t of the log ratios, one for each data set.
void test_over_datasets(const std::vector<RunningSums>& sums, PairOfRenderers& pair) {
  std::vector<double> ratios;
  for (const RunningSums& one : sums) ratios.push_back(score_on(one, pair.better) - score_on(one, pair.other));
  const auto n = static_cast<double>(ratios.size());
  const double mean = std::accumulate(ratios.begin(), ratios.end(), 0.0) / n;
  double squares = 0.0;
  for (const double one : ratios) squares += (one - mean) * (one - mean);
  const double standard_error = std::sqrt(squares / (n * (n - 1.0)));
  pair.degrees = n - 1.0;
  if (!(std::abs(mean) > rounding)) return;
  // Equal to rounding on every data set: nothing is more certain than p = 0.
  pair.t = mean / std::max(standard_error, 1e-12 * std::abs(mean));
  pair.p = stats::student_p(pair.t, pair.degrees);
}

// See ranking.h; bins in which both err alike are left out.
std::vector<double> paired_differences(const BinnedErrors& one, const BinnedErrors& other) {
  constexpr double alike = 1e-9;
  std::vector<std::pair<double, double>> squares;
  double both = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const auto n = static_cast<double>(one.samples[i]);
    const double a = one.squares_N2[i] / n;
    const double b = other.squares_N2[i] / n;
    if (!(std::abs(a - b) > alike * (a + b))) continue;
    squares.emplace_back(a, b);
    both += a + b;
  }
  const double share_of_all = 0.3 * std::sqrt(both / static_cast<double>(squares.size()));
  std::vector<double> out;
  for (const auto& [a, b] : squares) out.push_back((std::sqrt(a) - std::sqrt(b)) / (std::sqrt(a + b) + share_of_all));
  return out;
}

// The mean over recordings, with Welch and Satterthwaite's degrees of freedom. Recordings on which two err alike
// throughout count as 0.
void test_within_recordings(const std::vector<DatasetErrors>& datasets, PairOfRenderers& pair) {
  double mean = 0.0;
  double variance = 0.0;
  double by_degrees = 0.0;
  double degrees = 0.0;
  const auto m = static_cast<double>(datasets.size());
  for (const DatasetErrors& errors : datasets) {
    const std::vector<double> differences = paired_differences(errors[pair.better], errors[pair.other]);
    if (differences.empty()) {
      degrees += stats::fewest_degrees;
      continue;
    }
    const stats::SeriesMean own = stats::series_mean(differences);
    if (own.degrees == 0.0) return;
    mean += own.mean / m;
    const double share = own.standard_error * own.standard_error / (m * m);
    variance += share;
    by_degrees += share * share / own.degrees;
    degrees += own.degrees;
  }
  pair.degrees = variance > 0.0 ? variance * variance / by_degrees : degrees;
  // Smaller in most stretches of time, but not in all together, or the other way round.
  if (!(std::abs(mean) > rounding) || (mean > 0.0) != (pair.log_ratio > 0.0)) return;
  pair.t = mean / std::max(std::sqrt(variance), 1e-9 * std::abs(mean));
  pair.p = stats::student_p(pair.t, pair.degrees);
}

void judge_pairs(const std::vector<DatasetErrors>& datasets, const std::vector<RunningSums>& sums, double level,
                 Ranking& ranking) {
  std::vector<double> p;
  bool tested = false;
  for (PairOfRenderers& pair : ranking.pairs) {
    if (ranking.datasets_resampled) {
      test_over_datasets(sums, pair);
    } else {
      test_within_recordings(datasets, pair);
    }
    tested = tested || pair.degrees > 0.0;
    p.push_back(pair.p);
  }
  const double share = ranking.datasets_resampled ? share_over_datasets : share_within_recordings;
  const auto verdicts = stats::judge_all_pairs(p, ranking.order.size(), share * level);
  for (std::size_t i = 0; i < p.size(); ++i) {
    ranking.pairs[i].level = verdicts[i].level;
    ranking.pairs[i].told_apart = verdicts[i].differ;
  }
  if (tested || p.empty()) return;
  ranking.why_not =
      fmt::format("the recording is too short, or its errors are correlated over too long ({} stretches of {} s)",
                  sums.front().bins, error_bin_s);
}

void make_groups(Ranking& ranking) {
  const std::size_t n = ranking.order.size();
  std::size_t covered = 0;  // a group that ends no later than the one before lies within it
  for (std::size_t first = 0; first < n; ++first) {
    std::size_t last = first;
    const auto joins = [&](std::size_t next) {
      for (std::size_t i = first; i < next; ++i) {
        if (ranking.told_apart(ranking.order[i].renderer, ranking.order[next].renderer)) return false;
      }
      return true;
    };
    while (last + 1 < n && joins(last + 1)) ++last;
    if (last == first || last + 1 <= covered) continue;
    covered = last + 1;
    std::vector<std::size_t> group;
    for (std::size_t i = first; i <= last; ++i) group.push_back(ranking.order[i].renderer);
    ranking.groups.push_back(std::move(group));
  }
}

void make_order(const std::vector<RunningSums>& sums, Ranking& ranking) {
  for (std::size_t r = 0; r < sums.front().squares.size(); ++r) {
    double score = 0.0;
    for (const RunningSums& one : sums) score += score_on(one, r);
    ranking.order.push_back({r, score / static_cast<double>(sums.size()), 0.0, 0.0, 1, 1});
  }
  std::ranges::stable_sort(ranking.order, {}, &RankedRenderer::log_score);
  for (std::size_t i = 0; i < ranking.order.size(); ++i) {
    for (std::size_t j = i + 1; j < ranking.order.size(); ++j) {
      PairOfRenderers pair;
      pair.better = ranking.order[i].renderer;
      pair.other = ranking.order[j].renderer;
      pair.log_ratio = ranking.order[i].log_score - ranking.order[j].log_score;
      ranking.pairs.push_back(pair);
    }
  }
}

}  // namespace

bool Ranking::told_apart(std::size_t one, std::size_t other) const {
  return std::ranges::any_of(pairs, [&](const PairOfRenderers& pair) {
    return pair.told_apart &&
           ((pair.better == one && pair.other == other) || (pair.better == other && pair.other == one));
  });
}

Ranking rank_renderers(const std::vector<DatasetErrors>& datasets, const RankingOptions& options) {
  check_errors(datasets);
  Ranking ranking;
  ranking.datasets_resampled = datasets.size() >= fewest_sampled;
  std::vector<RunningSums> sums;
  for (const DatasetErrors& errors : datasets) {
    ranking.block_bins.push_back(bins_of_a_block(errors));
    sums.push_back(running_sums(errors));
  }
  make_order(sums, ranking);
  judge_pairs(datasets, sums, options.level, ranking);
  set_intervals(draw_scores(sums, options, ranking), ranking);
  for (RankedRenderer& one : ranking.order) {
    one.worst_rank = ranking.order.size();
    for (const PairOfRenderers& pair : ranking.pairs) {
      if (!pair.told_apart) continue;
      if (pair.other == one.renderer) ++one.best_rank;
      if (pair.better == one.renderer) --one.worst_rank;
    }
  }
  make_groups(ranking);
  return ranking;
}

}  // namespace touchstone::pipeline
