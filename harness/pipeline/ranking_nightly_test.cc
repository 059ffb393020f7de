// False differences on 200 simulated boards of equal renderers of every kind, and a renderer that is 2 % better, on
// seeds that nothing was chosen on.
#include <cstdio>

#include "harness/pipeline/simulated_errors_for_test.h"

namespace touchstone::pipeline {
namespace {

constexpr std::uint64_t first_seed = 93000;

// More than so many of 200 boards a rate of exactly 5 % gives with a chance of less than 5 % / 48: 48 kinds are looked
// at, and of 48 kinds that hold 5 % one shows 14 or more almost surely. The rates themselves, counted on 4,000 and
// 10,000 boards of every kind, are 0.2 to 4.2 %.
constexpr std::size_t most_by_chance = 21;

TEST(RankingNightly, EqualRenderersAreNotRankedOnAnyKindOfBoard) {
  struct Kind {
    std::size_t datasets, bins;
    double between;
  };
  std::size_t boards = 0;
  std::size_t found = 0;
  for (const std::string_view kind : error_kinds) {
    for (const std::size_t renderers : {2, 9}) {
      for (const Kind& of : {Kind{8, 240, 0.05}, Kind{2, 240, 0.0}, Kind{1, 240, 0.0}, Kind{1, 600, 0.0}}) {
        const auto counts =
            count_boards(kind, std::vector<double>(renderers, 0.1), of.datasets, of.bins, of.between, first_seed);
        std::printf("%zu renderers, %zu data sets, %zu bins, %s: %zu of 200\n", renderers, of.datasets, of.bins,
                    std::string(kind).c_str(), counts.with_a_difference);
        boards += 200;
        found += counts.with_a_difference;
        EXPECT_LE(counts.with_a_difference, most_by_chance)
            << kind << ' ' << renderers << ' ' << of.datasets << ' ' << of.bins;
      }
    }
  }
  std::printf("all: %zu of %zu\n", found, boards);
  EXPECT_LE(static_cast<double>(found), 0.05 * static_cast<double>(boards));
}

TEST(RankingNightly, TwoPercentAreFound) {
  std::size_t found = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + 200; ++seed) {
    const auto errors = simulated_board({0.098, 0.1, 0.1}, 8, 300, 0.02, 0.003, seed);
    const Ranking ranking = rank_renderers(errors, {0.05, 1, seed});
    found += ranking.told_apart(0, 1) && ranking.order.front().renderer == 0 ? 1 : 0;
  }
  std::printf("2 %% better on each of 8 data sets: found on %zu of 200\n", found);
  EXPECT_GE(found, 180u);
  std::size_t on_one = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + 200; ++seed) {
    const auto errors = simulated_board({0.098, 0.1, 0.1}, 1, 600, 0.02, 0.0, seed);
    on_one += rank_renderers(errors, {0.05, 1, seed}).told_apart(0, 1) ? 1 : 0;
  }
  std::printf("2 %% better on one recording of 60 s: found on %zu of 200\n", on_one);
  EXPECT_GE(on_one, 150u);
}

}  // namespace
}  // namespace touchstone::pipeline
