// The spring experiment of Shao, Wu and Ouyang (sections 3 and 4) on simulated processes: which of their findings hold
// here, how often over seeds, and on what that depends.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "experiments/spring_conditions.h"
#include "harness/perception/perceptual_evaluation.h"
#include "harness/perception/subjective_comparison.h"

namespace touchstone::experiments {

// What one run says of the conditions, smaller is better, in the order of spring_conditions().
struct Costs {
  std::vector<double> space;      // distance in perception space
  std::vector<double> euclidean;  // distance of the force
  std::vector<double> pearson;    // 1 less the correlation of the force
};

// What the paper finds, as a statement about one run.
struct Finding {
  std::string name;
  std::string statement;
  bool (*holds)(const Costs& costs);
  bool uses_space;  // else it does not depend on the scaling of features
};
const std::vector<Finding>& spring_findings();

// One way to set up what the paper leaves open.
struct Variant {
  std::string name;
  std::string what;
  SpringSetup setup;
  perception::HapticImageOptions image;
};
// The first is the base: its pictures are shown.
std::vector<Variant> spring_variants();

struct Share {
  std::size_t held = 0;
  std::size_t of = 0;
  [[nodiscard]] double value() const { return static_cast<double>(held) / static_cast<double>(of); }
  // Wilson (1927) interval, 95 %.
  [[nodiscard]] double low95() const;
  [[nodiscard]] double high95() const;
};

struct VariantResult {
  Variant variant;
  // By finding, then by scaling rule (feature_scalings); a finding about statistics alone has one entry.
  std::vector<std::vector<Share>> findings;
  // By feature, with that feature alone, unscaled: the findings about the space.
  std::vector<std::vector<Share>> by_feature;
  std::vector<std::string> features;
  // Mean over the seeds: distance of every condition by scaling rule, by feature (reference-norm), by statistic.
  std::vector<std::vector<double>> mean_distance;
  std::vector<std::vector<double>> mean_block_distance;
  std::vector<std::vector<double>> mean_statistic;
  double mean_dimensions = 0.0;
  double mean_explained_share = 0.0;
  // Spearman's rho of every method with the order of likeness that the paper's subjects gave: by method, one per seed.
  std::vector<std::string> methods;
  std::vector<std::vector<double>> agreement;
};

// How the findings depend on the force of the press, by either law's rule, scaled by reference-norm.
struct ScanPoint {
  QuadraticRule rule;
  double full_stroke_force_N;
  std::vector<Share> findings;
};

// Presses from half of what the weakest device can give to more than the strongest can.
std::vector<ScanPoint> spring_scan_points();

struct SpringExperiment {
  std::vector<std::string> conditions;
  std::vector<ScanPoint> scan;
  std::uint64_t first_seed = 1;
  std::size_t seeds = 0;
  std::vector<VariantResult> variants;
  perception::PerceptualEvaluation example;             // base variant, first seed
  perception::SubjectiveComparison simulated_subjects;  // of the example: ten observers who feel its distances
};

// The scan needs no more: it shows where a finding begins and ends, not how sure it is.
inline constexpr std::size_t scan_seeds = 20;

struct SpringSeed;  // apps/experiments/spring_seed.h
// Everything over the seeds that ran, in their order; the example is made anew of the first.
SpringExperiment gather_springs(std::uint64_t first_seed, const std::vector<SpringSeed>& seeds);

SpringExperiment run_spring_experiment(std::uint64_t first_seed, std::size_t seeds,
                                       const std::function<void(std::size_t done, std::size_t of)>& progress);

// Everything of it as JSON, "touchstone-springs/1".
std::string spring_experiment_to_json(const SpringExperiment& experiment);

}  // namespace touchstone::experiments
