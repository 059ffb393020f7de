#include "harness/pipeline/ranking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/pipeline/block_length.h"
#include "harness/stats/quantile.h"

namespace touchstone::pipeline {
namespace {

// At most so many blocks are made of a recording: long ones are nearly independent also where errors are correlated
// over longer than the automatic length sees (batch means with a fixed number of batches: Alexopoulos and Goldsman, ACM
// TOMACS 14, 2004). How uncertain a spread from so few is, the studentised draws know.
constexpr std::size_t kMostBlocks = 8;

constexpr double kNever = 1e300;  // a deviation that no pair exceeds

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

// As long as the difference of any renderer from the mean of all needs, and not shorter than a `kMostBlocks`-th.
std::size_t bins_of_a_block(const DatasetErrors& errors) {
  const std::size_t n = errors.front().size();
  std::vector<double> mean(n, 0.0);
  for (const BinnedErrors& one : errors) {
    for (std::size_t i = 0; i < n; ++i) mean[i] += one.squares_N2[i] / static_cast<double>(errors.size());
  }
  std::size_t longest = std::max<std::size_t>(1, n / kMostBlocks);
  std::vector<double> difference(n);
  for (const BinnedErrors& one : errors) {
    for (std::size_t i = 0; i < n; ++i) difference[i] = one.squares_N2[i] - mean[i];
    longest = std::max(longest, automatic_block_length(difference));
  }
  return longest;
}

// The errors of every renderer on one data set as blocks: what a draw is made of.
struct Blocks {
  std::vector<double> samples;               // [block]
  std::vector<std::vector<double>> squares;  // [renderer][block]
};

void add_block(const RunningSums& sums, std::size_t from, std::size_t length, Blocks& out) {
  out.samples.push_back(sums.samples[from + length] - sums.samples[from]);
  for (std::size_t r = 0; r < sums.squares.size(); ++r)
    out.squares[r].push_back(sums.squares[r][from + length] - sums.squares[r][from]);
}

// The recording itself, cut into blocks that lie side by side; a last one that is shorter than half joins its
// neighbour.
Blocks cut(const RunningSums& sums, std::size_t block) {
  Blocks out{{}, std::vector<std::vector<double>>(sums.squares.size())};
  const std::size_t count = std::max<std::size_t>(1, (sums.bins + block / 2) / block);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t from = k * block;
    add_block(sums, from, (k + 1 == count ? sums.bins : from + block) - from, out);
  }
  return out;
}

// As many blocks drawn with replacement, from anywhere on the circle.
Blocks draw(const RunningSums& sums, std::size_t block, Random& random) {
  Blocks out{{}, std::vector<std::vector<double>>(sums.squares.size())};
  const std::size_t count = std::max<std::size_t>(1, (sums.bins + block / 2) / block);
  for (std::size_t k = 0; k < count; ++k) add_block(sums, random.below(sums.bins), block, out);
  return out;
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// A log ratio and the square of its standard error.
struct Estimate {
  double value = 0.0;
  double variance = 0.0;
};

// Of two renderers on one data set, by the delta method: log(RMS_a / RMS_b) moves by (A_k / A - B_k / B) / 2 with the
// sums of block k.
Estimate log_ratio(const Blocks& blocks, std::size_t a, std::size_t b) {
  const double all_a = sum_of(blocks.squares[a]);
  const double all_b = sum_of(blocks.squares[b]);
  const double samples = sum_of(blocks.samples);
  const auto n = static_cast<double>(blocks.samples.size());
  Estimate out{half_log(all_a, samples) - half_log(all_b, samples), 0.0};
  if (n < 2.0 || !(all_a > 0.0) || !(all_b > 0.0)) return out;
  for (std::size_t k = 0; k < blocks.samples.size(); ++k) {
    const double influence = 0.5 * (blocks.squares[a][k] / all_a - blocks.squares[b][k] / all_b);
    out.variance += influence * influence * n / (n - 1.0);
  }
  return out;
}

// The variance of the same from the correlation of the bins: what neighbouring blocks share is in it, too.
double variance_by_bins(const DatasetErrors& errors, std::size_t a, std::size_t b) {
  const double all_a = sum_of(errors[a].squares_N2);
  const double all_b = sum_of(errors[b].squares_N2);
  if (!(all_a > 0.0) || !(all_b > 0.0)) return 0.0;
  std::vector<double> influence;
  for (std::size_t i = 0; i < errors[a].size(); ++i)
    influence.push_back(0.5 * (errors[a].squares_N2[i] / all_a - errors[b].squares_N2[i] / all_b));
  return long_run_variance(influence) * static_cast<double>(influence.size());
}

// Over data sets: as a sample of objects the spread between them is the standard error, else what is left within each.
Estimate over_datasets(const std::vector<Blocks>& datasets, bool sampled, std::size_t a, std::size_t b) {
  const auto m = static_cast<double>(datasets.size());
  std::vector<Estimate> own;
  Estimate out;
  for (const Blocks& blocks : datasets) {
    own.push_back(log_ratio(blocks, a, b));
    out.value += own.back().value / m;
  }
  for (const Estimate& one : own) {
    out.variance +=
        sampled ? (one.value - out.value) * (one.value - out.value) / (m * (m - 1.0)) : one.variance / (m * m);
  }
  return out;
}

// What the draws say: the scores of every renderer, and how far each pair is off.
struct Draws {
  std::vector<std::vector<double>> scores;      // [renderer][draw]
  std::vector<std::vector<double>> deviations;  // studentised, [pair][draw]
};

Draws draw_all(const std::vector<RunningSums>& sums, const RankingOptions& options, const Ranking& ranking) {
  Draws out;
  const std::size_t renderers = sums.front().squares.size();
  out.scores.resize(renderers);
  out.deviations.resize(ranking.pairs.size());
  const Random root(options.seed);
  for (std::size_t i = 0; i < options.draws; ++i) {
    Random random = root.stream(i);
    std::vector<Blocks> drawn;
    for (std::size_t d = 0; d < sums.size(); ++d) {
      const std::size_t chosen = ranking.datasets_resampled ? random.below(sums.size()) : d;
      drawn.push_back(draw(sums[chosen], ranking.block_bins[chosen], random));
    }
    for (std::size_t r = 0; r < renderers; ++r) {
      double score = 0.0;
      for (const Blocks& blocks : drawn) score += half_log(sum_of(blocks.squares[r]), sum_of(blocks.samples));
      out.scores[r].push_back(score / static_cast<double>(drawn.size()));
    }
    for (std::size_t p = 0; p < ranking.pairs.size(); ++p) {
      const PairOfRenderers& pair = ranking.pairs[p];
      const Estimate own = over_datasets(drawn, ranking.datasets_resampled, pair.better, pair.other);
      const double off = std::abs(own.value - pair.log_ratio);
      out.deviations[p].push_back(own.variance > 0.0 ? off / std::sqrt(own.variance) : (off > 0.0 ? kNever : 0.0));
    }
  }
  return out;
}

// How often a log ratio as large as this appears if it is by chance alone which of two renderers was better in a block
// (Fisher's randomisation test: the two are swapped block by block; data sets that are a sample are swapped whole).
// Exact for equal renderers also if few episodes hold most of the error, where draws of blocks do not show how far off
// the ratio could have been. Every pattern of swaps is tried if `draws` are enough for that, else as many are drawn.
double chance_by_swaps(const std::vector<Blocks>& datasets, bool sampled, const PairOfRenderers& pair,
                       std::size_t draws, Random random) {
  std::size_t pieces = 0;
  for (const Blocks& blocks : datasets) pieces += sampled ? 1 : blocks.samples.size();
  const bool all = pieces < 63 && (std::uint64_t{1} << pieces) <= draws;
  const std::uint64_t patterns = all ? std::uint64_t{1} << pieces : draws;
  std::size_t as_large = all ? 0 : 1;
  const double found = std::abs(pair.log_ratio) * (1.0 - 1e-9);  // the pattern without swaps is as large as itself
  for (std::uint64_t pattern = 0; pattern < patterns; ++pattern) {
    double ratio = 0.0;
    std::size_t piece = 0;
    for (const Blocks& blocks : datasets) {
      double a = 0.0;
      double b = 0.0;
      bool swapped = false;
      for (std::size_t k = 0; k < blocks.samples.size(); ++k) {
        if (k == 0 || !sampled) swapped = all ? ((pattern >> piece++) & 1U) == 1U : random.below(2) == 1;
        a += blocks.squares[swapped ? pair.other : pair.better][k];
        b += blocks.squares[swapped ? pair.better : pair.other][k];
      }
      ratio += (half_log(a, 1.0) - half_log(b, 1.0)) / static_cast<double>(datasets.size());
    }
    as_large += std::abs(ratio) >= found ? 1 : 0;
  }
  return static_cast<double>(as_large) / static_cast<double>(all ? patterns : draws + 1);
}

// In how many blocks, or data sets that are a sample, the two did not err alike.
std::size_t pieces_that_differ(const std::vector<Blocks>& datasets, bool sampled, const PairOfRenderers& pair) {
  std::size_t pieces = 0;
  for (const Blocks& blocks : datasets) {
    std::size_t own = 0;
    for (std::size_t k = 0; k < blocks.samples.size(); ++k) {
      const double a = blocks.squares[pair.better][k];
      const double b = blocks.squares[pair.other][k];
      own += std::abs(a - b) > 1e-9 * std::max(a, b) ? 1 : 0;
    }
    pieces += sampled ? std::min<std::size_t>(own, 1) : own;
  }
  return pieces;
}

void judge_pairs(const std::vector<RunningSums>& sums, const Draws& draws, const RankingOptions& options,
                 Ranking& ranking) {
  // Sidak's share of the level for each pair, and enough swaps to resolve it.
  const double each =
      1.0 - std::pow(1.0 - options.level, 1.0 / static_cast<double>(std::max<std::size_t>(1, ranking.pairs.size())));
  ranking.pair_level = each;
  const std::size_t swaps = std::max(options.draws, static_cast<std::size_t>(std::ceil(4.0 / each)));
  std::vector<Blocks> whole;
  for (std::size_t d = 0; d < sums.size(); ++d) whole.push_back(cut(sums[d], ranking.block_bins[d]));
  constexpr double rounding = 1e-12;  // of a log ratio: errors that are equal but for the order of summation
  const Random root = Random(options.seed).stream(options.draws);
  for (std::size_t i = 0; i < ranking.pairs.size(); ++i) {
    PairOfRenderers& pair = ranking.pairs[i];
    pair.told_apart =
        ranking.why_not.empty() && std::abs(pair.log_ratio) > rounding &&
        std::abs(pair.log_ratio) > stats::reaching_quantile(draws.deviations[i], 1.0 - each) * pair.standard_error;
    if (!pair.told_apart) continue;
    // With few blocks no pattern is rarer than all of them on one side: then it must be that one. Blocks in which the
    // two erred alike, as in free air, say nothing and have no side.
    const double rarest =
        2.0 * std::pow(0.5, static_cast<double>(pieces_that_differ(whole, ranking.datasets_resampled, pair)));
    pair.told_apart =
        chance_by_swaps(whole, ranking.datasets_resampled, pair, swaps, root.stream(i)) <= std::max(each, rarest);
  }
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

// Of two renderers on the recordings themselves. Within recordings the larger of two consistent estimates counts: from
// blocks, and from the bins' correlation.
PairOfRenderers estimate_pair(const std::vector<DatasetErrors>& datasets, const std::vector<Blocks>& whole,
                              bool sampled, std::size_t better, std::size_t other) {
  Estimate estimate = over_datasets(whole, sampled, better, other);
  if (!sampled) {
    const auto m = static_cast<double>(datasets.size());
    double by_bins = 0.0;
    for (const DatasetErrors& errors : datasets) by_bins += variance_by_bins(errors, better, other) / (m * m);
    estimate.variance = std::max(estimate.variance, by_bins);
  }
  return {better, other, estimate.value, std::sqrt(estimate.variance), false};
}

void make_order(const std::vector<DatasetErrors>& datasets, const std::vector<RunningSums>& sums, Ranking& ranking) {
  std::vector<Blocks> whole;
  for (std::size_t d = 0; d < sums.size(); ++d) whole.push_back(cut(sums[d], ranking.block_bins[d]));
  for (std::size_t r = 0; r < sums.front().squares.size(); ++r) {
    double score = 0.0;
    for (const Blocks& blocks : whole) score += half_log(sum_of(blocks.squares[r]), sum_of(blocks.samples));
    ranking.order.push_back({r, score / static_cast<double>(whole.size()), 0.0, 0.0, 1, 1});
  }
  std::ranges::stable_sort(ranking.order, {}, &RankedRenderer::log_score);
  for (std::size_t i = 0; i < ranking.order.size(); ++i) {
    for (std::size_t j = i + 1; j < ranking.order.size(); ++j) {
      const std::size_t better = ranking.order[i].renderer;
      const std::size_t other = ranking.order[j].renderer;
      ranking.pairs.push_back(estimate_pair(datasets, whole, ranking.datasets_resampled, better, other));
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
  ranking.datasets_resampled = datasets.size() >= kFewestSampled;
  std::vector<RunningSums> sums;
  std::size_t blocks = 0;
  for (const DatasetErrors& errors : datasets) {
    ranking.block_bins.push_back(bins_of_a_block(errors));
    sums.push_back(running_sums(errors));
    blocks += errors.front().size() / ranking.block_bins.back();
  }
  if (!ranking.datasets_resampled && blocks < kFewestBlocks) {
    ranking.why_not = fmt::format(
        "the errors are correlated over so long that only {} independent blocks of time are "
        "there; {} are needed",
        blocks, kFewestBlocks);
  }
  make_order(datasets, sums, ranking);
  const Draws draws = draw_all(sums, options, ranking);
  judge_pairs(sums, draws, options, ranking);
  for (RankedRenderer& one : ranking.order) {
    one.low95 = stats::reaching_quantile(draws.scores[one.renderer], 0.025);
    one.high95 = stats::reaching_quantile(draws.scores[one.renderer], 0.975);
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
