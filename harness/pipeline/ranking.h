// Which renderer is better, as far as the recordings can tell.
//
// The score of a renderer is the mean over data sets of log(RMS force error), so that a data set with large forces
// does not outweigh the others. All renderers saw the same recording, so of two of them the paired difference is
// tested: what is hard for everybody cancels.
//
//  - Of one recording, and of fewer than `fewest_sampled`: the mean over bins of time of
//      (|e_a| - |e_b|) / (sqrt(e_a^2 + e_b^2) + 0.3 e),
//    with the RMS errors e_a, e_b in the bin and e of both in all bins. Bins in which both errors are equal, as
//    in free air, say nothing and are left out. Differences in shares of the error at hand, so that hard presses and
//    single large errors do not drown the rest: where one renderer errs five times as much all the time, it is so
//    after a few seconds. Its correlation in time harness/stats/series_mean.h takes into account. Both this and the RMS
//    error must be smaller. Equal renderers are two of which by chance alone the one or the other errs more in a
//    stretch of time; what is told apart is so for more seconds of this scan. Not covered: renderers with the same RMS
//    error, of which one errs steadily and the other in snags; these do differ, and may be told apart.
//  - Of `fewest_sampled` and more: Student's t of the log ratios, one number per data set, which are a sample of
//    objects and recordings (Demsar, JMLR 7, 2006, section 3.1.1). The result is about others like these
//    (`datasets_resampled`). Rank tests, which need no normal law, cannot tell any pair apart here: of eight data sets
//    the smallest p of Wilcoxon's is 0.008, and 36 pairs of nine renderers need 0.0014.
//  - Many pairs: Shaffer's procedure (harness/stats/all_pairs.h): the chance of one false difference or more on a
//    board is at most `level`. The tests get a third of it on one recording, four fifths over data sets: the rest
//    is for the correlation, which is estimated from the same few seconds, and for laws that are not normal.
//  - Ranks: [1 + how many are certainly better, N - how many are certainly worse] (Mogstad, Romano, Shaikh and Wilhelm
//    2024), of the same pairs and so at the same level.
//  - Groups: largest sets of neighbours in the order of scores in which no pair is told apart, as the bars of a
//    critical difference diagram (Demsar 2006).
//  - Intervals of scores and ratios, each for itself at 95 %: paired bootstrap over circular blocks of time (Politis
//    and Romano 1992), as long as block_length.h says, and over data sets if these are a sample. They show the size;
//    the tests above decide.
//
// ranking_test.cc and ranking_nightly_test.cc count false differences on simulated boards of equal renderers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/pipeline/binned_errors.h"

namespace touchstone::pipeline {

inline constexpr std::size_t fewest_sampled = 5;  // a spread from fewer says hardly anything

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
  double low95 = 0.0;                 // pointwise interval of log_ratio
  double high95 = 0.0;
  double t = 0.0;        // of the paired difference; 0 where it was not tested
  double degrees = 0.0;  // of Student's distribution; 0: this pair cannot be tested
  double p = 1.0;        // two-sided
  double level = 0.0;    // that p must not exceed
  bool told_apart = false;
};

struct Ranking {
  std::vector<RankedRenderer> order;             // best score first
  std::vector<PairOfRenderers> pairs;            // every pair once
  std::vector<std::vector<std::size_t>> groups;  // of renderers, best first; only those of at least two
  bool datasets_resampled = false;
  std::vector<std::size_t> block_bins;  // of the bootstrap, by data set
  std::string why_not;                  // why nothing could be tested, where that is so of the whole board

  [[nodiscard]] bool told_apart(std::size_t one, std::size_t other) const;
};

// `datasets` not empty, each with the same renderers, in the same order. Throws UsageError where bins differ or a
// renderer's errors are not finite: such a renderer does not enter.
Ranking rank_renderers(const std::vector<DatasetErrors>& datasets, const RankingOptions& options = {});

}  // namespace touchstone::pipeline
