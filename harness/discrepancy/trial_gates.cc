#include "harness/discrepancy/trial_gates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/discrepancy/parameter_intervals.h"
#include "harness/discrepancy/regimes.h"
#include "harness/discrepancy/smoothed_comparison.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

bool moves_surface(const Model& model, const std::string& effect) {
  return find_entry(model, effect)->parameters.contains("amplitude_m");
}

// A bump or a texture of the mesh that is not there, by more than its makers declare.
bool trial_displaces_for_sure(const SearchState& state, const Trial& trial) {
  const auto effects = trial.effects();
  const auto moves = [&](const std::string& name) { return moves_surface(trial.fit.model, name); };
  if (std::none_of(effects.begin(), effects.end(), moves)) return true;
  const int iterations = state.settings->iterations;
  const JointFit fit = fit_jointly(state.train, trial.fit.model, trial.parameters, iterations, true);
  const auto for_sure = [&](const std::vector<NullFit>& draws) {
    return std::all_of(effects.begin(), effects.end(), [&](const std::string& name) {
      return displaces_for_sure(state, fit, trial.parameters, draws, name);
    });
  };
  // By its covariance first, which is cheap; then with what noise and an error of the mesh elsewhere make of its size.
  return for_sure({}) &&
         for_sure(bootstrap_fits(state.data->train, state.train, fit, trial.parameters, iterations / 2));
}

bool helps_without_noise(const SearchState& state, const Trial& trial) {
  const auto compared = state.compared();
  const auto loss = compare_smoothed(*state.data, state.train, state.validation, {&trial.fit.model, &trial.parameters},
                                     {&state.current.model, &compared}, state.settings->iterations);
  return !loss || loss->lost >= state.settings->likely_share * trial.validation_gain;
}

}  // namespace

bool within_mesh_error(const SearchState& state, const Model& model, const std::string& effect) {
  const Evidence& train = state.data->train;
  const double moved_m = surface_displacement_m(state.library().traits(effect), *find_entry(model, effect),
                                                train.recording->motion, train.predictor->predict(model).n_W);
  return moved_m <= state.settings->mesh_margin * state.data->geometry_error_m;
}

bool displaces_for_sure(const SearchState& state, const JointFit& fit, const std::vector<FreeParameter>& parameters,
                        const std::vector<NullFit>& draws, const std::string& effect) {
  return !moves_surface(fit.model, effect) || least_size95(fit, parameters, draws, effect, "amplitude_m") >
                                                  state.settings->mesh_margin * state.data->geometry_error_m;
}

TrialVerdict cheap_gates(const SearchState& state, const BaselineScore& baseline, const Trial& trial) {
  const SearchSettings& settings = *state.settings;
  if (!(trial.train_gain >= settings.minimum_gain)) return "no more than noise on the training blocks";
  if (!(trial.validation_gain >= settings.minimum_gain)) return "no more than noise on the validation blocks";
  // What acts in a few moments alone, such as a lag, gains in a few blocks, but in those of both recordings.
  if (trial.log_likelihood_z < settings.gain_errors && trial.likelier_both < settings.both_gain_errors) {
    return "its gain comes from a few validation blocks alone";
  }
  const double before = baseline.validation_rms_N * baseline.validation_rms_N;
  const double removed = before - trial.validation_rms_N * trial.validation_rms_N;
  const double noticed_N = settings.just_noticeable_share * state.validation_force_N;
  if (!(removed >= noticed_N * noticed_N)) {
    // Few blocks see an effect of one place or of small depths: it has little of the chi-squared of all, in which
    // besides what is missing counts as noise. All the same what removes half of what noise leaves matters.
    const auto seen = [&] {
      const double seen_N = settings.noise_share * expected_noise_N(state.data->validation, trial.fit.model);
      return removed >= seen_N * seen_N;
    };
    const double least = state.least_share(trial.fit.model);
    const bool shares = trial.validation_gain >= least * baseline.validation_chi_squared || seen();
    if (!shares || !(removed >= least * before)) return "too small to matter";
  }
  for (const std::string& name : trial.effects()) {
    if (within_mesh_error(state, trial.fit.model, name)) return within_mesh();
  }
  return "";
}

TrialVerdict costly_gates(const SearchState& state, const Trial& trial) {
  rendering::Predictor& predictor = *state.data->validation.predictor;
  const auto regimes = sort_by_regime(state.data->validation, predictor.predict(state.current.model),
                                      predictor.predict(trial.fit.model), state.data->force_floor_N);
  const std::string worse = worsened_phase(regimes, state.settings->worsening);
  if (!worse.empty()) return fmt::format("makes {} worse", worse);
  if (!helps_without_noise(state, trial)) {
    return {TrialVerdict::Kind::noisy_positions_alone,
            "helps at the noisy positions alone: it passes less of their noise on"};
  }
  if (!trial_displaces_for_sure(state, trial)) return maybe_within_mesh();
  return "";
}

double null_threshold(const SearchState& state, const RefitInWorld& refits, double gain) {
  const SearchSettings& settings = *state.settings;
  const auto compared = state.compared();
  const NullCase null{&state.data->train, &state.data->validation, &state.train,
                      &state.validation,  &state.current.model,    &compared,
                      settings.iterations};
  auto gains = null_gains(null, refits, 0, few_worlds);
  const double bar = std::max(settings.minimum_gain, bar_above(gains, settings.null_deviations));
  if (is_clear(gain, bar)) return bar;
  const auto more = null_gains(null, refits, few_worlds, NoiseModel::null_simulations);
  gains.insert(gains.end(), more.begin(), more.end());
  return std::max(settings.minimum_gain, bar_above(gains, settings.null_deviations));
}

double null_threshold(const SearchState& state, const rendering::Candidate& candidate, double gain) {
  const auto refit = [&](const FitData& train, const recording::Recording& recording, const Model& base) {
    const CandidateFit options = state.options(candidate, base, recording);
    return std::vector<JointFit>{best_fit(train, base, options, state.compared(), state.settings->iterations)};
  };
  return null_threshold(state, refit, gain);
}

const Trial* explained_by_mesh(const std::vector<Trial>& trials, const Trial& trial) {
  const auto does = [&](const Trial& other) {
    return other.verdict.kind == TrialVerdict::Kind::within_mesh_tolerance && other.train_gain >= trial.train_gain &&
           other.validation_gain >= trial.validation_gain;
  };
  const auto found = std::find_if(trials.begin(), trials.end(), does);
  return found == trials.end() ? nullptr : &*found;
}

TrialVerdict all_gates(const SearchState& state, const BaselineScore& baseline, Trial& trial) {
  TrialVerdict verdict = cheap_gates(state, baseline, trial);
  if (verdict.passed()) verdict = costly_gates(state, trial);
  if (!verdict.passed()) return verdict;
  trial.null_threshold = null_threshold(state, state.candidate(trial.name), trial.validation_gain);
  // Fits that ended with the time are no bar.
  if (!state.budget->allows("the checks of " + trial.title())) return out_of_time;
  return trial.validation_gain > trial.null_threshold ? "" : within_null;
}

}  // namespace touchstone::discrepancy
