#include "harness/discrepancy/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/field_prior.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

double in_errors(double gain, double error) { return error > 0.0 ? gain / error : 0.0; }

}  // namespace

std::vector<std::string> Trial::effects() const {
  return partner.empty() ? std::vector<std::string>{name} : std::vector<std::string>{name, partner};
}

std::string Trial::title() const { return partner.empty() ? name : name + " and " + partner; }

BaselineScore baseline_score(const SearchState& state) {
  BaselineScore baseline;
  baseline.train_blocks = block_chi_squared(state.train, state.current.model);
  baseline.validation_blocks = block_chi_squared(state.validation, state.current.model);
  baseline.deviances = state.block_deviances(state.current.model);
  baseline.train_chi_squared = std::accumulate(baseline.train_blocks.begin(), baseline.train_blocks.end(), 0.0);
  baseline.validation_chi_squared =
      std::accumulate(baseline.validation_blocks.begin(), baseline.validation_blocks.end(), 0.0);
  baseline.validation_rms_N = state.validation_rms_N(state.current.model);
  return baseline;
}

void score(const SearchState& state, const BaselineScore& baseline, Trial& trial) {
  const Model& model = trial.fit.model;
  std::tie(trial.train_gain, trial.train_error) =
      paired_difference(baseline.train_blocks, block_chi_squared(state.train, model));
  std::tie(trial.validation_gain, trial.validation_error) =
      paired_difference(baseline.validation_blocks, block_chi_squared(state.validation, model));
  trial.validation_rms_N = state.validation_rms_N(model);
  const auto deviances = state.block_deviances(model);
  trial.log_likelihood_z = trial.likelier_both = -std::numeric_limits<double>::infinity();
  trial.deviance = std::accumulate(deviances.validation.begin(), deviances.validation.end(), 0.0);
  for (const auto difference : {paired_difference, trimmed_difference}) {
    const auto [learnt, learnt_error] = difference(baseline.deviances.train, deviances.train);
    const auto [judged, judged_error] = difference(baseline.deviances.validation, deviances.validation);
    trial.log_likelihood_z = std::max(trial.log_likelihood_z, in_errors(judged, judged_error));
    trial.likelier_both =
        std::max(trial.likelier_both, in_errors(learnt + judged, std::hypot(learnt_error, judged_error)));
  }
}

std::optional<Trial> try_candidate(const SearchState& state, const BaselineScore& baseline,
                                   const rendering::Candidate& candidate) {
  const Model& model = state.current.model;
  if (find_entry(model, candidate.name) != nullptr || state.library().has_what_contains(model, candidate.name))
    return std::nullopt;
  const Model rest = state.library().without_special_cases(model, candidate.name);
  const CandidateFit options = state.options(candidate, rest);
  Trial trial;
  trial.name = candidate.name;
  trial.side = candidate.side;
  trial.parameters = without_coefficients(state.free_in(rest));
  const int iterations = state.settings->iterations;
  // What gains less than the least that counts is not fitted to the end. Fields have a prior beside chi-squared.
  const double abandon_above = prior_rows(rest) > 0 ? std::numeric_limits<double>::infinity()
                                                    : baseline.train_chi_squared - state.settings->minimum_gain;
  trial.fit =
      best_fit(state.train, rest, options, trial.parameters, FitEffort{iterations, iterations / 3, abandon_above});
  if (!trial.fit.ok) return std::nullopt;
  trial.parameters = joined(std::move(trial.parameters), options.parameters);
  score(state, baseline, trial);
  return trial;
}

std::vector<Trial> try_candidates(const SearchState& state, const BaselineScore& baseline) {
  std::vector<std::optional<Trial>> tried(state.candidates->size());
  const std::size_t number = state.current.model.effects.size() + state.current.model.instrument.size() + 1;
  const auto one = [&](std::size_t i) {
    const rendering::Candidate& candidate = (*state.candidates)[i];
    if (is_field(candidate.parameters)) return;  // field_move.h
    if (!state.budget->allows(fmt::format("{} as effect number {}", candidate.name, number))) return;
    tried[i] = try_candidate(state, baseline, candidate);
  };
  in_parallel(tried.size(), one, 1);
  std::vector<Trial> trials;
  for (auto& trial : tried) {
    if (trial) trials.push_back(std::move(*trial));
  }
  return trials;
}

SearchState with_trial(const SearchState& state, const Trial& trial) {
  SearchState next = state;
  next.parameters = trial.parameters;
  for (const FreeParameter& parameter : state.parameters) {
    const bool held = parameter.coefficient && find_entry(trial.fit.model, parameter.owner) != nullptr;
    if (held) next.parameters.push_back(parameter);
  }
  next.current = trial.fit;
  next.renew_noise(next.current.model);
  next.refit();
  return next;
}

}  // namespace touchstone::discrepancy
