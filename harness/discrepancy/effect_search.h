// Which effects are missing: a stepwise search with joint fits, every add, swap and drop judged on held-out blocks.
//
// At each step every candidate is fitted jointly with the base parameters and the effects found so far, on the training
// blocks; it is scored on the held-out ones. The best is kept when it gains more than noise can, matters in practice
// and makes no regime worse; else the next is tried. Then effects that a better set no longer needs are dropped. Rivals
// that explain the held-out data as well are listed; when they cannot be told apart, that is the finding.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/discrepancy/candidate_starts.h"
#include "harness/discrepancy/joint_fit.h"
#include "harness/discrepancy/noise_model.h"

namespace touchstone {

struct SearchSettings {
  double minimum_gain = 60.0;   // of held-out chi-squared, and of training chi-squared per parameter: / 3
  double minimum_share = 0.02;  // of the held-out mean-square error
  std::size_t most_effects = 4;
  int iterations = 12;
  std::uint64_t seed = 1;
};

// One candidate's try at one step.
struct Trial {
  std::string name;
  Side side = Side::contact;
  JointFit fit;
  double train_gain = 0.0;  // of chi-squared against the model without it
  double holdout_gain = 0.0;
  double holdout_rms_N = 0.0;  // of the 3-D force error, all samples
  double gain_error = 0.0;     // standard error of holdout_gain against the best trial of the step, by block bootstrap
  std::string verdict;         // why it was kept or not
};

struct SearchStep {
  std::vector<Trial> trials;  // best first
  std::string added;          // empty: none was strong enough
};

// Two recordings with the same cause, seen through predictors.
struct SearchData {
  const Recording* train = nullptr;
  const Recording* holdout = nullptr;
  Predictor* train_predictor = nullptr;
  Predictor* holdout_predictor = nullptr;
  NoiseModel* train_noise = nullptr;
  NoiseModel* holdout_noise = nullptr;
  double window_s = 0.0;
  double force_floor_N = 0.0;  // a measured force above it is contact
};

struct SearchResult {
  Model base;    // the starting model with its base parameters refitted
  Model model;   // with the effects found
  JointFit fit;  // of `model`, with covariance
  std::vector<FreeParameter> parameters;
  std::vector<SearchStep> steps;
  double base_holdout_rms_N = 0.0;  // of the starting model as given
  double train_rms_before_N = 0.0;
  double train_rms_after_N = 0.0;
  double holdout_rms_after_N = 0.0;
  double expected_holdout_rms_N = 0.0;  // what noise alone would leave by the noise model
  double goodness = 0.0;                // held-out chi-squared per degree of freedom of `model` under its own noise
};

using Report = std::function<void(const std::string&)>;

SearchResult search_effects(const SearchData& data, const Model& start, const std::vector<Candidate>& candidates,
                            const SearchSettings& settings, const Report& report);

double rms_force_error_N(const Recording& recording, const Prediction& prediction);

}  // namespace touchstone
