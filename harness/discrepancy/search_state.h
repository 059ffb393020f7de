// What a search knows at one moment: the model found so far with what is free in it, and the blocks of both recordings
// under the noise that goes with that model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/discrepancy/candidate_starts.h"
#include "harness/discrepancy/effect_library.h"
#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/search_settings.h"
#include "harness/discrepancy/time_budget.h"

namespace touchstone::discrepancy {

// What is pointed to must outlive it. A copy is a state of its own, but for the predictors, which are shared.
struct SearchState {
  // Not yet fitted: `current` is `start`. Throws BadData when the starting model cannot run or has no stiffness to fit.
  SearchState(const SearchData& evidence, const std::vector<rendering::Candidate>& library,
              const SearchSettings& limits, const rendering::Model& first);

  const SearchData* data;
  const std::vector<rendering::Candidate>* candidates;
  const SearchSettings* settings;
  std::shared_ptr<TimeBudget> budget;  // of the whole search: copies share it
  rendering::Model start;
  std::vector<FreeParameter> parameters;  // free in `current`
  JointFit current;
  FitData declared_train;  // under the declared noise alone
  FitData declared_validation;
  FitData train;  // with the current model's misfit
  FitData validation;
  double validation_force_N = 0.0;  // RMS of the measured force, on the validation blocks

  // Noise follows the model: friction adds its own, damping too. What the model lacks counts as noise until it is
  // found.
  void renew_noise(const rendering::Model& model);
  // Within the time; `to_the_end`: however long it takes.
  void refit(bool to_the_end = false);

  // Under the noise of the current model and the misfit that the given one leaves on the training blocks.
  struct BlockDeviance {
    std::vector<double> train;
    std::vector<double> validation;
  };
  [[nodiscard]] BlockDeviance block_deviances(const rendering::Model& model) const;
  [[nodiscard]] double validation_deviance(const rendering::Model& model) const;
  [[nodiscard]] double validation_rms_N(const rendering::Model& model) const;

  // Of the validation error's square, and of the validation chi-squared, that an effect of this model must explain.
  [[nodiscard]] double least_share(const rendering::Model& model) const;

  [[nodiscard]] EffectLibrary library() const { return EffectLibrary(*candidates); }
  [[nodiscard]] const rendering::Candidate& candidate(const std::string& name) const;
  // How the candidate enters a fit of that model, to the training recording or to another of its motion.
  [[nodiscard]] CandidateFit options(const rendering::Candidate& candidate, const rendering::Model& model) const;
  [[nodiscard]] CandidateFit options(const rendering::Candidate& candidate, const rendering::Model& model,
                                     const recording::Recording& recording) const;
  // Of samples of the training recording and what is predicted there.
  [[nodiscard]] rendering::RecordingScales scales(const recording::Recording& seen,
                                                  const rendering::Prediction& now) const;
  // What is free now without that of entries which `model` has no more.
  [[nodiscard]] std::vector<FreeParameter> free_in(const rendering::Model& model) const;
  // What is free while effects are compared: all but the coefficients of fields.
  [[nodiscard]] std::vector<FreeParameter> compared() const { return without_coefficients(parameters); }
};

std::vector<FreeParameter> joined(std::vector<FreeParameter> parameters, const std::vector<FreeParameter>& more);

}  // namespace touchstone::discrepancy
