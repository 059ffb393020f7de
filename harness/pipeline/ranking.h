// Which renderer is better, as far as the recordings can tell: a paired block bootstrap over blocks of time and, if
// there are enough of them, over data sets.
//
// The score of a renderer is the mean over data sets of log(RMS force error), so that a data set with large forces
// does not outweigh the others; of two renderers it is the difference that counts, a log ratio. All renderers saw the
// same recording, so each draw takes the same blocks for all of them (paired): what is hard for everybody cancels.
//
//  - Blocks: errors are correlated in time. Circular blocks of bins are drawn, as long as the differences between
//    renderers need (block_length.h; Kuensch 1989, Politis and Romano 1992).
//  - Data sets: with at least `kFewestSampled` they are drawn with replacement, too, and the result is about objects
//    like these; with fewer it is about these recordings alone (`datasets_resampled`).
//  - Many pairs: two renderers are told apart if |log ratio| / standard error exceeds a quantile of the studentised
//    deviations of that pair over the draws (bootstrap-t: Hall 1992), at Sidak's share of `level` for each pair, so
//    that the chance of one false statement on the whole board is at most `level`. Each draw is studentised by its own
//    standard error: few blocks or data sets, and errors that a few episodes dominate, widen it. A randomisation test
//    must agree (Fisher 1935): the two are swapped block by block, data sets that are a sample as a whole.
//  - Ranks: [1 + how many are certainly better, N - how many are certainly worse] (Mogstad, Romano, Shaikh and Wilhelm
//    2024), of the same pairs and so at the same level.
//  - Groups: largest sets of neighbours in the order of scores in which no pair is told apart, as the bars of a
//    critical difference diagram (Demsar, JMLR 7, 2006).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/pipeline/binned_errors.h"

namespace touchstone::pipeline {

inline constexpr std::size_t kFewestSampled = 5;  // a spread from fewer says hardly anything
inline constexpr std::size_t kFewestBlocks = 6;   // independent blocks without which nothing is told apart

struct RankingOptions {
  double level = 0.05;  // chance of one false statement on a board
  std::size_t draws = 2000;
  std::uint64_t seed = 1;
};

// The errors of every renderer on one data set; all have the same bins.
using DatasetErrors = std::vector<BinnedErrors>;

struct RankedRenderer {
  std::size_t renderer = 0;  // its place in DatasetErrors
  double log_score = 0.0;    // mean of log(RMS error / N)
  double low95 = 0.0;        // pointwise interval of log_score
  double high95 = 0.0;
  std::size_t best_rank = 1;  // of the interval; 1 is the best
  std::size_t worst_rank = 1;
};

struct PairOfRenderers {
  std::size_t better = 0, other = 0;  // by score
  double log_ratio = 0.0;             // of `better` over `other`, <= 0
  double standard_error = 0.0;
  bool told_apart = false;
};

struct Ranking {
  std::vector<RankedRenderer> order;             // best score first
  std::vector<PairOfRenderers> pairs;            // every pair once
  std::vector<std::vector<std::size_t>> groups;  // of renderers, best first; only those of at least two
  double pair_level = 0.0;                       // Sidak's share of the level for each pair
  bool datasets_resampled = false;
  std::vector<std::size_t> block_bins;  // by data set
  std::string why_not;                  // why nothing is told apart, where that is so of the whole board

  [[nodiscard]] bool told_apart(std::size_t one, std::size_t other) const;
};

// `datasets` not empty, each with the same renderers, in the same order. Throws UsageError where bins differ or a
// renderer's errors are not finite: such a renderer does not enter.
Ranking rank_renderers(const std::vector<DatasetErrors>& datasets, const RankingOptions& options = {});

}  // namespace touchstone::pipeline
