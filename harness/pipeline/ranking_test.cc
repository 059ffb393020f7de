#include "harness/pipeline/ranking.h"

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/pipeline/block_length.h"
#include "harness/pipeline/pareto.h"
#include "harness/pipeline/simulated_errors_for_test.h"

namespace touchstone::pipeline {
namespace {

// At most 5 % of 200 boards of equal renderers may show any difference: on eight data sets that suit one renderer or
// the other at random, on two, and on one recording alone of 24 s and of a minute.
TEST(Ranking, EqualRenderersAreNotRanked) {
  for (const std::string_view kind : error_kinds) {
    for (const std::size_t renderers : {2, 9}) {
      const std::vector<double> equal(renderers, 0.1);
      EXPECT_LE(count_boards(kind, equal, 8, 240, 0.05, 1).with_a_difference, 10u) << kind << ' ' << renderers;
      EXPECT_LE(count_boards(kind, equal, 1, 240, 0.0, 1).with_a_difference, 10u) << kind << ' ' << renderers;
    }
  }
}

// On one recording of 24 s a person sees the difference, and so does the board.
TEST(Ranking, FiveTimesTheErrorIsFoundOnOneRecording) {
  const std::vector<double> scale{0.06, 0.34, 0.34, 0.34, 0.34, 0.34, 0.34, 0.34, 0.34};
  EXPECT_GE(count_boards("half-second", scale, 1, 240, 0.0, 1).first_is_better, 180u);
  EXPECT_GE(count_boards("strokes", scale, 1, 240, 0.0, 1).first_is_better, 150u);
}

// A renderer that is worse all the time but seldom by much is not drowned by the few seconds in which both are bad, and
// one snag of the better one does not hide it.
TEST(Ranking, ASingleSnagIsNoDifferenceAndHidesNone) {
  Random random(4);
  DatasetErrors errors = simulated_errors("half-second", {0.05, 0.1}, 200, random);
  DatasetErrors equal = simulated_errors("half-second", {0.1, 0.1}, 200, random);
  for (DatasetErrors* const one : {&errors, &equal}) {
    for (std::size_t i = 50; i < 55; ++i) (*one)[0].squares_N2[i] += 6.0 * 0.04;
  }
  EXPECT_TRUE(rank_renderers({errors}).told_apart(0, 1));
  EXPECT_FALSE(rank_renderers({equal}).told_apart(0, 1));
}

TEST(Ranking, IdenticalErrorsAreOneGroup) {
  Random random(3);
  DatasetErrors errors = simulated_errors("half-second", {0.1}, 300, random);
  errors.push_back(errors.front());
  const Ranking ranking = rank_renderers({errors});
  ASSERT_EQ(ranking.groups.size(), 1u);
  EXPECT_EQ(ranking.groups.front().size(), 2u);
  EXPECT_EQ(ranking.order[0].worst_rank, 2u);
  EXPECT_EQ(ranking.order[1].best_rank, 1u);
}

// 2 % better on each of eight data sets, and nothing better than it by chance.
TEST(Ranking, TwoPercentAreFound) {
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto errors = simulated_board({0.098, 0.1, 0.1}, 8, 300, 0.02, 0.003, seed);
    const Ranking ranking = rank_renderers(errors, {0.05, 500, seed});
    found += ranking.told_apart(0, 1) && ranking.order.front().renderer == 0 ? 1 : 0;
  }
  EXPECT_GE(found, 45u);
}

TEST(Ranking, RanksAndGroupsFollowThePairs) {
  const Ranking ranking = rank_renderers(simulated_board({0.2, 0.1, 0.1, 0.4}, 6, 300, 0.02, 0.005, 5));
  EXPECT_TRUE(ranking.datasets_resampled);
  EXPECT_EQ(ranking.order[2].renderer, 0u);
  EXPECT_EQ(ranking.order[3].renderer, 3u);
  EXPECT_EQ(ranking.order[0].best_rank, 1u);
  EXPECT_EQ(ranking.order[0].worst_rank, 2u);
  EXPECT_EQ(ranking.order[2].best_rank, 3u);
  EXPECT_EQ(ranking.order[2].worst_rank, 3u);
  ASSERT_EQ(ranking.groups.size(), 1u) << "1 and 2 are equal, the others stand alone";
  EXPECT_NEAR(ranking.order[3].log_score - ranking.order[2].log_score, std::log(2.0), 0.05);
}

// The unit of force and the order of the renderers change nothing.
TEST(Ranking, DoesNotDependOnUnitOrOrder) {
  auto errors = simulated_board({0.1, 0.11, 0.13}, 2, 200, 0.05, 0.0, 11);
  const Ranking one = rank_renderers(errors);
  for (DatasetErrors& dataset : errors) {
    std::ranges::reverse(dataset);
    for (BinnedErrors& renderer : dataset) {
      for (double& square : renderer.squares_N2) square *= 1e6;
    }
  }
  const Ranking other = rank_renderers(errors);
  EXPECT_FALSE(one.datasets_resampled);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(one.order[i].renderer, 2 - other.order[i].renderer);
    EXPECT_EQ(one.order[i].best_rank, other.order[i].best_rank);
    EXPECT_NEAR(one.order[i].log_score + std::log(1e3), other.order[i].log_score, 1e-9);
  }
}

TEST(Ranking, WhatIsNoNumberOrWasJudgedElsewhereIsRefused) {
  Random random(1);
  DatasetErrors errors = simulated_errors("half-second", {0.1, 0.1}, 50, random);
  DatasetErrors shorter = errors;
  shorter[1].samples.pop_back();
  shorter[1].squares_N2.pop_back();
  EXPECT_THROW(rank_renderers({shorter}), UsageError);
  errors[0].squares_N2[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(rank_renderers({errors}), UsageError);
  EXPECT_THROW(rank_renderers({}), UsageError);
}

TEST(Ranking, TooShortARecordingTellsNothingApart) {
  Random random(1);
  const Ranking ranking = rank_renderers({simulated_errors("half-second", {0.1, 0.2}, 15, random)});
  EXPECT_FALSE(ranking.why_not.empty());
  EXPECT_FALSE(ranking.told_apart(0, 1));
}

TEST(BlockLength, GrowsWithTheCorrelation) {
  Random random(2);
  std::size_t before = 0;
  for (const double stay : {0.0, 0.5, 0.9}) {
    std::vector<double> series{0.0};
    while (series.size() < 2000) series.push_back(stay * series.back() + random.normal());
    const std::size_t length = automatic_block_length(series);
    EXPECT_GT(length, before) << stay;
    before = length;
  }
  // Patton, Politis and White's optimum for an AR(1): (6 n rho^2 / (1 - rho^2)^2)^(1/3), 87.5 bins here.
  EXPECT_NEAR(static_cast<double>(before), std::cbrt(6.0 * 2000.0 * 0.81 / (0.19 * 0.19)), 45.0);
  EXPECT_EQ(automatic_block_length(std::vector<double>(100, 1.0)), 1u);
}

TEST(BinnedErrors, AreTheRootMeanSquareOfTheSamples) {
  ErrorBinner binner;
  double squares = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double error = std::sin(0.1 * i);
    if (i < 400 || i >= 600) {
      binner.add(5.0 + 0.01 * i, error * error);
      squares += error * error;
    }
  }
  EXPECT_NEAR(binner.errors().rms_N(), std::sqrt(squares / 800.0), 1e-12);
  EXPECT_NEAR(static_cast<double>(binner.errors().size()), 80.0, 2.0) << "a gap has no bins";
  EXPECT_TRUE(std::isnan(BinnedErrors{}.rms_N()));
}

TEST(Pareto, KeepsWhatNothingBeatsInEverything) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<double>> costs{{1, 5}, {2, 2}, {3, 3}, {5, 1}, {2, 2}, {nan, 0}};
  EXPECT_EQ(pareto_front(costs), (std::vector<bool>{true, true, false, true, true, false}));
}

}  // namespace
}  // namespace touchstone::pipeline
