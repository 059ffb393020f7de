// Which of all pairs of k things differ, at a stated chance of one false statement among them.
//
// Source: Shaffer, Modified sequentially rejective multiple test procedures, JASA 81 (1986), procedure S1; for pairwise
// comparisons of methods over data sets: Garcia and Herrera, JMLR 9 (2008). As Holm's procedure it goes from the
// smallest p on and stops where p exceeds level / t; but t is not the number of pairs that are left: with one pair
// unequal not all others can be equal (if a differs from b, c differs from a or from b), and t is the largest number of
// pairs that can be equal still. It holds whatever the tests' dependence.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace touchstone::stats {

// How many of the k (k - 1) / 2 pairs can be equal at the same time, ascending: 0, 1, 3 of three things.
std::vector<std::size_t> possible_equal_pairs(std::size_t things);

// For every pair the level that its p must not exceed once all smaller ones are rejected, and whether it is rejected.
struct PairVerdict {
  double level = 0.0;
  bool differ = false;
};

// `p`: two-sided, of every pair of `things` once, in any order.
std::vector<PairVerdict> judge_all_pairs(std::span<const double> p, std::size_t things, double level);

}  // namespace touchstone::stats
