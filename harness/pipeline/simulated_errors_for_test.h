// Errors of renderers on recordings as they occur, with known truth: for counting false differences.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/random.h"
#include "harness/pipeline/ranking.h"

namespace touchstone::pipeline {

// half-second, two-seconds: a common difficulty of the recording and a part of each renderer's own, log-normal and
//   correlated over so long (AR(1) per bin of 0.1 s).
// own: as the first, but mostly of each renderer's own.
// strokes: strokes of 1.2 to 2.8 s with pauses in free air, where nobody errs; each stroke suits one or the other.
// snags: a small steady error, and about four times in a recording a large one for 0.3 to 1.1 s.
// wander: a common part and a slow one (correlated over 4 s) of each renderer's own.
inline constexpr std::array<std::string_view, 6> error_kinds{"half-second", "two-seconds", "own",
                                                             "strokes",     "snags",       "wander"};

class Correlated {
 public:
  Correlated(double stay, Random& random) : stay_(stay), now_(random.normal()) {}
  double next(Random& random) {
    now_ = stay_ * now_ + std::sqrt(1.0 - stay_ * stay_) * random.normal();
    return now_;
  }

 private:
  double stay_;
  double now_;
};

// Mean square error 1 times scale^2 for all kinds, but for chance and a factor that all renderers share.
inline DatasetErrors simulated_errors(std::string_view kind, const std::vector<double>& scale, std::size_t bins,
                                      Random& random, double own_share = 0.1) {
  constexpr std::uint64_t samples = 6;
  const std::size_t n = scale.size();
  std::vector<std::vector<double>> square(n, std::vector<double>(bins, 0.0));
  const double stay = kind == "two-seconds" ? 0.95 : kind == "own" ? 0.9 : kind == "wander" ? 0.7 : 0.8;
  Correlated common(stay, random);
  std::vector<Correlated> own;
  for (std::size_t r = 0; r < n; ++r) own.emplace_back(kind == "wander" ? 0.975 : stay, random);
  if (kind == "own") own_share = 0.5;
  if (kind == "strokes") {
    for (std::size_t at = 0; at < bins;) {
      at += 3 + random.below(10);
      const std::size_t length = 12 + random.below(17);
      const double hard = 0.6 * random.normal();
      std::vector<double> suits;
      for (std::size_t r = 0; r < n; ++r) suits.push_back(0.3 * random.normal());
      for (std::size_t k = 0; k < length && at < bins; ++k, ++at) {
        const double press = std::sin(3.14159265 * (static_cast<double>(k) + 0.5) / static_cast<double>(length));
        for (std::size_t r = 0; r < n; ++r)
          square[r][at] = std::pow(scale[r] * press * std::exp(hard + suits[r] + 0.1 * random.normal()), 2);
      }
    }
  } else {
    for (std::size_t i = 0; i < bins; ++i) {
      const double hard = common.next(random);
      for (std::size_t r = 0; r < n; ++r) {
        const double mine = own[r].next(random);
        double size = scale[r] * std::exp(0.5 * hard + own_share * mine);
        if (kind == "wander") size = scale[r] * std::hypot(0.8 + 0.5 * hard, std::sqrt(0.5) * mine);
        if (kind == "snags") size = scale[r] * std::exp(0.1 * random.normal());
        square[r][i] = size * size;
      }
    }
  }
  for (std::size_t r = 0; kind == "snags" && r < n; ++r) {
    for (std::size_t i = 0; i < bins; ++i) {
      if (random.uniform() > 4.0 / static_cast<double>(bins)) continue;
      const double size = 5.0 * scale[r] * std::exp(0.7 * random.normal());
      const std::size_t end = std::min(bins, i + 3 + static_cast<std::size_t>(random.below(9)));
      for (std::size_t k = i; k < end; ++k) square[r][k] += size * size;
    }
  }
  DatasetErrors out(n);
  for (std::size_t r = 0; r < n; ++r) {
    for (const double one : square[r]) {
      out[r].squares_N2.push_back(static_cast<double>(samples) * one);
      out[r].samples.push_back(samples);
    }
  }
  return out;
}

inline std::vector<DatasetErrors> simulated_board(const std::vector<double>& scale, std::size_t datasets,
                                                  std::size_t bins, double own_share, double between,
                                                  std::uint64_t seed, std::string_view kind = "half-second") {
  std::vector<DatasetErrors> out;
  const Random root(seed);
  for (std::size_t d = 0; d < datasets; ++d) {
    Random random = root.stream(d);
    // How much a renderer suits an object differs from object to object, without favouring any.
    std::vector<double> here = scale;
    for (double& one : here) one *= std::exp(between * random.normal());
    out.push_back(simulated_errors(kind, here, bins, random, own_share));
  }
  return out;
}

struct BoardCounts {
  std::size_t with_a_difference = 0;
  std::size_t first_is_better = 0;
};

// Of 200 boards.
inline BoardCounts count_boards(std::string_view kind, const std::vector<double>& scale, std::size_t datasets,
                                std::size_t bins, double between, std::uint64_t first_seed) {
  BoardCounts out;
  for (std::uint64_t seed = first_seed; seed < first_seed + 200; ++seed) {
    const auto errors = simulated_board(scale, datasets, bins, 0.1, between, seed, kind);
    const Ranking ranking = rank_renderers(errors, {0.05, 1, seed});
    out.with_a_difference += std::ranges::any_of(ranking.pairs, &PairOfRenderers::told_apart) ? 1 : 0;
    out.first_is_better += ranking.told_apart(0, 1) && ranking.order.front().renderer == 0 ? 1 : 0;
  }
  return out;
}

}  // namespace touchstone::pipeline
