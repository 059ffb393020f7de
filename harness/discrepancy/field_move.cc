#include "harness/discrepancy/field_move.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/regimes.h"
#include "harness/discrepancy/trial_gates.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;

namespace {

struct FieldTrial {
  Trial trial;
  CandidateFit options;  // with the one start whose smoothness was chosen
};

// From the smoothest on, each from where the one before ended; the one that the validation blocks prefer.
std::optional<FieldTrial> try_field(const SearchState& state, const BaselineScore& baseline,
                                    const rendering::Candidate& candidate) {
  const Model rest = state.library().without_special_cases(state.current.model, candidate.name);
  const CandidateFit options = state.options(candidate, rest);
  std::optional<FieldTrial> best;
  std::optional<NamedParameters> reached;
  for (const NamedParameters& start : options.starts) {
    NamedParameters from = reached.value_or(start);
    from.parameters.at("bend") = start.parameters.at("bend");
    Trial trial;
    trial.name = candidate.name;
    trial.side = candidate.side;
    trial.parameters = joined(without_coefficients(state.free_in(rest)), options.parameters);
    const Model& around = best ? best->trial.fit.model : rest;
    trial.fit = fit_jointly(state.train, with_entry(without_entry(around, candidate.name), candidate.side, from),
                            trial.parameters, state.settings->field_iterations, false);
    if (!trial.fit.ok) continue;
    reached = *find_entry(trial.fit.model, candidate.name);
    score(state, baseline, trial);
    // Not in order: what a field leaves on the training blocks counts as noise.
    if (best && !(trial.deviance < best->trial.deviance)) continue;
    CandidateFit chosen = options;
    chosen.starts = {start};
    best = FieldTrial{std::move(trial), std::move(chosen)};
  }
  return best;
}

// What such a field gains where nothing is missing.
double bar_of_field(const SearchState& state, const FieldTrial& tried) {
  constexpr std::size_t worlds = 4;
  const SearchSettings& settings = *state.settings;
  const auto compared = state.compared();
  const NullCase null{&state.data->train, &state.data->validation, &state.train,
                      &state.validation,  &state.current.model,    &compared,
                      settings.iterations};
  const auto refit = [&](const FitData& train, const recording::Recording&, const Model& base) {
    const Model rest = state.library().without_special_cases(base, tried.trial.name);
    return std::vector<JointFit>{fit_jointly(train, with_entry(rest, tried.options.side, tried.options.starts.front()),
                                             tried.trial.parameters, settings.field_iterations / 2, false)};
  };
  return std::max(settings.minimum_gain, bar_above(null_gains(null, refit, 0, worlds), settings.null_deviations));
}

TrialVerdict refusal_of_field(const SearchState& state, const BaselineScore& baseline, FieldTrial& tried) {
  TrialVerdict verdict = cheap_gates(state, baseline, tried.trial);
  if (!verdict.passed()) return verdict;
  rendering::Predictor& predictor = *state.data->validation.predictor;
  const auto regimes = sort_by_regime(state.data->validation, predictor.predict(state.current.model),
                                      predictor.predict(tried.trial.fit.model), state.data->force_floor_N);
  const std::string worse = worsened_phase(regimes, state.settings->worsening);
  if (!worse.empty()) return fmt::format("makes {} worse", worse);
  tried.trial.null_threshold = bar_of_field(state, tried);
  if (!state.budget->allows("the checks of " + tried.trial.title())) return out_of_time;
  return tried.trial.validation_gain > tried.trial.null_threshold ? "" : within_null;
}

}  // namespace

bool has_field(const Model& model) {
  const auto is = [](const NamedParameters& entry) { return rendering::is_field(entry.parameters); };
  return std::any_of(model.effects.begin(), model.effects.end(), is) ||
         std::any_of(model.instrument.begin(), model.instrument.end(), is);
}

bool differs_over_surface(const Model& model, const EffectLibrary& library) {
  using Peaks = rendering::EffectTraits::Peaks;
  const auto does = [&](const NamedParameters& entry) {
    const Peaks peaks = library.traits(entry.name).peaks;
    return rendering::is_field(entry.parameters) || peaks == Peaks::stiffness || peaks == Peaks::height;
  };
  return std::any_of(model.effects.begin(), model.effects.end(), does) ||
         std::any_of(model.instrument.begin(), model.instrument.end(), does);
}

std::vector<Trial> try_fields(const SearchState& state, const BaselineScore& baseline) {
  std::vector<FieldTrial> tried;
  for (const rendering::Candidate& candidate : *state.candidates) {
    if (!is_field(candidate.parameters) || find_entry(state.current.model, candidate.name) != nullptr) continue;
    if (!state.budget->allows(candidate.name)) continue;
    if (auto one = try_field(state, baseline, candidate)) tried.push_back(std::move(*one));
  }
  std::sort(tried.begin(), tried.end(),
            [](const FieldTrial& a, const FieldTrial& b) { return a.trial.deviance < b.trial.deviance; });
  std::vector<Trial> trials;
  bool passed = false;
  for (FieldTrial& one : tried) {
    one.trial.verdict = passed ? "not judged: a better field passed" : refusal_of_field(state, baseline, one);
    passed = passed || one.trial.verdict.passed();
    trials.push_back(std::move(one.trial));
  }
  return trials;
}

bool field_is_better(const std::vector<Trial>& fields, const std::vector<Trial>& trials) {
  const auto least = [](const std::vector<Trial>& of) {
    double deviance = std::numeric_limits<double>::infinity();
    for (const Trial& trial : of) {
      if (trial.verdict.passed()) deviance = std::min(deviance, trial.deviance);
    }
    return deviance;
  };
  return least(fields) < least(trials);
}

}  // namespace touchstone::discrepancy
