#include "harness/discrepancy/search_state.h"

#include <algorithm>
#include <utility>

#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Candidate;
using rendering::Model;
using rendering::Prediction;

SearchState::SearchState(const SearchData& evidence, const std::vector<Candidate>& library,
                         const SearchSettings& limits, const Model& first)
    : data(&evidence),
      candidates(&library),
      settings(&limits),
      budget(std::make_shared<TimeBudget>(limits.time_limit_s, limits.begun, limits.checks_s)),
      start(first),
      parameters{base_stiffness(first)} {
  current.model = start;
  Prediction nothing;
  nothing.f_W_N.assign(data->validation.recording->size(), Vec3::Zero());
  validation_force_N = rms_force_error_N(data->validation, nothing);
  renew_noise(start);
}

void SearchState::renew_noise(const Model& model) {
  train = fit_data(data->train, model, data->window_s);
  validation = fit_data(data->validation, model, data->window_s);
  train.budget = validation.budget = budget.get();
  declared_train = train;
  declared_validation = validation;
  const Misfit misfit = estimate_misfit(train, model);
  add_misfit(train, misfit);
  add_misfit(validation, misfit);
}

void SearchState::refit(bool to_the_end) {
  const bool fields = std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.coefficient; });
  // Nearly linear in a field's coefficients: a few steps do.
  const int iterations = fields ? settings->field_iterations : settings->iterations;
  train.budget = to_the_end ? nullptr : budget.get();
  JointFit fit = fit_jointly(train, Model(current.model), parameters, iterations, false);
  train.budget = budget.get();
  if (fit.ok) current = std::move(fit);
}

SearchState::BlockDeviance SearchState::block_deviances(const Model& model) const {
  FitData fitted = declared_train;
  FitData judged = declared_validation;
  const Misfit misfit = estimate_misfit(declared_train, model);
  add_misfit(fitted, misfit);
  add_misfit(judged, misfit);
  return {block_deviance(fitted, model), block_deviance(judged, model)};
}

double SearchState::validation_deviance(const Model& model) const {
  FitData judged = declared_validation;
  add_misfit(judged, estimate_misfit(declared_train, model));
  return deviance(judged, model);
}

double SearchState::validation_rms_N(const Model& model) const {
  return rms_force_error_N(data->validation, data->validation.predictor->predict(model));
}

double SearchState::least_share(const Model& model) const {
  const bool clear = validation_rms_N(model) > settings->clear_noises * expected_noise_N(data->validation, model);
  return clear ? settings->clear_share : settings->minimum_share;
}

const Candidate& SearchState::candidate(const std::string& name) const {
  return *std::find_if(candidates->begin(), candidates->end(), [&](const Candidate& c) { return c.name == name; });
}

CandidateFit SearchState::options(const Candidate& candidate, const Model& model) const {
  return options(candidate, model, *data->train.recording);
}

CandidateFit SearchState::options(const Candidate& candidate, const Model& model, const Recording& recording) const {
  // The places where an effect may be are looked up in what is left there: not in blocks that judge it.
  const Part& part = data->train.part;
  const Recording seen = samples_of(part, recording);
  const Prediction now = samples_of(part, recording.motion, data->train.predictor->predict(model));
  return candidate_fit(candidate, scales(seen, now), seen, now);
}

rendering::RecordingScales SearchState::scales(const Recording& seen, const Prediction& now) const {
  // The start's stiffness: that of a model which hardly touches was fitted to nothing.
  return measure_scales(seen, now, data->force_floor_N, start.parameters.at("stiffness_N_per_m"),
                        data->position_noise_m);
}

std::vector<FreeParameter> SearchState::free_in(const Model& model) const {
  std::vector<FreeParameter> kept = parameters;
  std::erase_if(kept, [&](const FreeParameter& parameter) {
    return find_entry(current.model, parameter.owner) != nullptr && find_entry(model, parameter.owner) == nullptr;
  });
  return kept;
}

std::vector<FreeParameter> joined(std::vector<FreeParameter> parameters, const std::vector<FreeParameter>& more) {
  parameters.insert(parameters.end(), more.begin(), more.end());
  return parameters;
}

}  // namespace touchstone::discrepancy
