#include "harness/recording_checks/block_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/base/random.h"

namespace touchstone::recording_checks {
namespace {

TEST(Assign, IsTheCheapestOfAllPermutations) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const std::size_t n = 1 + static_cast<std::size_t>(trial) % 6;
    std::vector<std::vector<double>> cost(n, std::vector<double>(n));
    for (auto& row : cost) {
      for (double& c : row) c = random.uniform(-1.0, 1.0);
    }
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    const auto sum = [&](const std::vector<std::size_t>& place) {
      double total = 0.0;
      for (std::size_t r = 0; r < n; ++r) total += cost[r][place[r]];
      return total;
    };
    double least = 1e9;
    do least = std::min(least, sum(order));
    while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(sum(assign(cost)), least, 1e-12);
  }
}

struct Loads {
  std::vector<double> t_s, measured, modelled;
};

// Presses of random depth and time at 200 Hz, 30 s; the measured load has a law that the model lacks, and noise.
Loads presses(Random& random, double noise) {
  Loads loads;
  std::vector<double> at, deep, wide;
  for (int k = 0; k < 40; ++k) {
    at.push_back(random.uniform(0.0, 30.0));
    deep.push_back(random.uniform(0.2, 1.0));
    wide.push_back(random.uniform(0.1, 0.6));
  }
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.005 * i;
    double depth = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) depth += deep[k] * std::exp(-std::pow((t - at[k]) / wide[k], 2));
    loads.t_s.push_back(t);
    loads.modelled.push_back(depth);
    loads.measured.push_back(3.0 * std::pow(depth, 1.5) + noise * random.normal());
  }
  return loads;
}

void shuffle_seconds(std::vector<double>& values, Random& random) {
  const std::size_t block = 200;
  for (std::size_t b = values.size() / block - 1; b > 0; --b) {
    const std::size_t other = random.below(b + 1);
    for (std::size_t i = 0; i < block; ++i) std::swap(values[b * block + i], values[other * block + i]);
  }
}

TEST(BlockOrder, ShuffledSecondsAreFoundWithTheirLength) {
  Random random(2);
  for (int world = 0; world < 20; ++world) {
    Loads loads = presses(random, 0.1);
    shuffle_seconds(loads.measured, random);
    const auto order = find_wrong_order(loads.t_s, loads.measured, loads.modelled);
    ASSERT_TRUE(order) << world;
    EXPECT_LT(order->correlation, order->reordered);
    EXPECT_GT(order->reordered, 0.9);
  }
}

TEST(BlockOrder, APartThatStandsFirstInsteadOfLastIsFound) {
  Random random(5);
  for (int world = 0; world < 10; ++world) {
    Loads loads = presses(random, 0.1);
    const double unspoiled = correlation(loads.measured, loads.modelled);
    std::rotate(loads.measured.begin(), loads.measured.begin() + 1234, loads.measured.end());
    const auto order = find_wrong_order(loads.t_s, loads.measured, loads.modelled);
    ASSERT_TRUE(order) << world;
    EXPECT_GT(order->reordered, 0.8 * unspoiled);
    EXPECT_LT(order->correlation, order->reordered);
  }
}

TEST(BlockOrder, GoodRecordingsAreNotBlamed) {
  Random random(3);
  for (int world = 0; world < 20; ++world) {
    const Loads loads = presses(random, 0.3);
    EXPECT_FALSE(find_wrong_order(loads.t_s, loads.measured, loads.modelled)) << world;
  }
}

// What a search trains on: a piece of every `period` s.
Loads every_other(const Loads& all, double piece_s, double period_s) {
  Loads part;
  for (std::size_t i = 0; i < all.t_s.size(); ++i) {
    if (!(std::fmod(all.t_s[i] + 1e-9, period_s) < piece_s)) continue;
    part.t_s.push_back(all.t_s[i]);
    part.measured.push_back(all.measured[i]);
    part.modelled.push_back(all.modelled[i]);
  }
  return part;
}

TEST(BlockOrder, BlocksDoNotGoOverWhatIsLeftOut) {
  Random random(6);
  for (int world = 0; world < 20; ++world) {
    Loads loads = every_other(presses(random, 0.1), 2.0, 4.0);
    EXPECT_FALSE(find_wrong_order(loads.t_s, loads.measured, loads.modelled)) << world;
    shuffle_seconds(loads.measured, random);
    const auto order = find_wrong_order(loads.t_s, loads.measured, loads.modelled);
    ASSERT_TRUE(order) << world;
    EXPECT_LE(order->block_s, 1.0);
    EXPECT_GT(order->reordered, 0.9);
  }
}

// A tool weighs 1.2 N, which the model does not know: what pushes takes away from the size of the force, and a bump in
// one place adds to it.
TEST(BlockOrder, AWeightAndABumpInPiecesOfARecordingAreHardlyEverBlamed) {
  Random random(7);
  int blamed = 0;
  for (int world = 0; world < 300; ++world) {
    Loads loads = presses(random, 0.0);
    for (std::size_t i = 0; i < loads.t_s.size(); ++i) {
      const double bump = 0.8 * std::exp(-std::pow((std::fmod(loads.t_s[i], 9.0) - 4.0) / 1.5, 2));
      const double push = loads.modelled[i] > 0.1 ? loads.modelled[i] + bump : 0.0;
      loads.measured[i] = std::abs(1.2 - 1.3 * push) + 0.02 * random.normal();
    }
    const Loads part = every_other(loads, 0.99, 2.04);
    blamed += find_wrong_order(part.t_s, part.measured, part.modelled) ? 1 : 0;
  }
  EXPECT_LE(blamed, 3);  // the stated rate of the gate, 1 % (docs/explanation/recording-check-rates.md)
}

TEST(BlockOrder, ALoadThatDoesNotVaryOrFollowsNothingIsNotBlamed) {
  Random random(4);
  for (int world = 0; world < 20; ++world) {
    Loads loads = presses(random, 0.0);
    double drift = 0.0;
    for (double& v : loads.measured) drift = 0.99 * drift + 0.02 * random.normal(), v = 2.0 + drift;  // force control
    EXPECT_FALSE(find_wrong_order(loads.t_s, loads.measured, loads.modelled)) << world;
    std::fill(loads.measured.begin(), loads.measured.end(), 2.0);
    EXPECT_FALSE(find_wrong_order(loads.t_s, loads.measured, loads.modelled));
    // Quasi-periodic presses against a model that has another object: nothing to blame the order for.
    for (std::size_t i = 0; i < loads.measured.size(); ++i) loads.measured[i] = std::sin(12.0 * loads.t_s[i]);
    EXPECT_FALSE(find_wrong_order(loads.t_s, loads.measured, loads.modelled)) << world;
  }
}

}  // namespace
}  // namespace touchstone::recording_checks
