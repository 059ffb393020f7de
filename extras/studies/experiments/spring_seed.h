// What one seed of the spring experiment gives: all that the experiment says over its seeds follows from these numbers.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "experiments/spring_experiment.h"

namespace touchstone::experiments {

struct SpringSeed {
  // One way to set up what the paper leaves open; the conditions in the order of spring_conditions().
  struct OfVariant {
    std::vector<std::vector<double>> spaces;  // distance by scaling rule (feature_scalings), by condition
    std::vector<std::string> features;
    std::vector<std::vector<double>> blocks;      // distance by feature alone, by condition
    std::vector<std::vector<double>> statistics;  // by method of statistical_methods(), by condition
    // Spearman's rho with the order that the paper's subjects gave: the perception space, the statistical methods, then
    // methods_beside().
    std::vector<double> agreement;
    double dimensions = 0.0;
    double explained_share = 0.0;
    [[nodiscard]] Costs costs(std::vector<double> space) const;
  };
  std::vector<OfVariant> variants;  // of spring_variants()
  std::vector<Costs> scan;          // of spring_scan_points(); empty where the seed is not one of the scan's
};

// What the paper does not have: the judge's d' first, then ST-SIM, SPQI and Stevens' law.
const std::vector<std::string>& methods_beside();

// `part_done` is called after every evaluation, spring_parts() times.
SpringSeed run_spring_seed(std::uint64_t seed, bool scanned, const std::function<void()>& part_done);
std::size_t spring_parts(bool scanned);
// The base variant's evaluation, whole: for the report's pictures.
perception::PerceptualEvaluation spring_example(std::uint64_t seed);

std::string spring_seed_to_json(const SpringSeed& seed);
// Throws BadData for other text.
SpringSeed spring_seed_from_json(const std::string& text);

}  // namespace touchstone::experiments
