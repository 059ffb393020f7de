// A simulated observer makes the answers of a paired-comparison experiment: one who feels the distance of every
// condition from the real process with noise (Thurstone's discriminal process, case V) and cannot tell differences
// below a just noticeable one, where the answer is a guess. For tests and for experiments without people; never
// evidence about people.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/perception/subjective/paired_comparisons.h"

namespace touchstone::perception {

struct SimulatedObserver {
  double noise = 1.0;                     // standard deviation of one felt distance, in the unit of the distances
  double just_noticeable_difference = 0;  // felt differences below it are guessed
  double order_bias = 0.0;                // added to the felt nearness of what comes first
  double subject_spread = 0.0;            // standard deviation of a condition's distance between subjects
};

// Every subject compares all pairs in one order and then in the reverse order, as in the paper: n (n - 1) answers each.
// Deterministic in `seed`. Throws UsageError unless there is one distance for each condition.
PairedComparisons simulate_answers(const std::vector<std::string>& conditions, std::span<const double> distance_to_real,
                                   std::size_t subjects, const SimulatedObserver& observer, std::uint64_t seed);

}  // namespace touchstone::perception
