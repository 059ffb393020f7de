#include "harness/discrepancy/nested_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/friction_cone.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/regimes.h"
#include "harness/discrepancy/trial_gates.h"
#include "harness/rendering/smooth_field.h"
#include "harness/stats/quantile.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::Prediction;
using rendering::Predictor;

namespace {

constexpr std::size_t fewest_worlds = 4;  // for a bar

// What the sensor showed, of the blocks of both recordings.
struct Shown {
  std::vector<Vec3> train_N;
  std::vector<Vec3> validation_N;
};

struct Judged {
  JointFit fit;
  double train = 0.0;  // -2 ln likelihood, less a constant
  double validation = 0.0;
};

struct Law {
  Model model;  // where its fit starts
  std::vector<FreeParameter> parameters;
};

// The blocks on the smoothed trajectory, under the noise of the model if it were the truth.
FitData smoothed_comparison(const Evidence& evidence, const Model& model, double window_s,
                            const std::vector<Vec3>& shown_N) {
  FitData blocks = fit_data(evidence, model, window_s);
  blocks.predictor = &evidence.noise->likely_predictor();
  blocks.measured_N = shown_N;
  return blocks;
}

// The noise follows the model and the fit the noise, in turns.
std::optional<Judged> judge(const SearchState& state, const Law& law, const Shown& shown, int rounds) {
  const SearchData& data = *state.data;
  Judged judged;
  judged.fit.model = law.model;
  for (int round = 0; round < rounds; ++round) {
    const Model from = judged.fit.model;
    FitData train = smoothed_comparison(data.train, from, data.window_s, shown.train_N);
    add_misfit(train, estimate_misfit(train, from));
    train.budget = state.budget.get();
    judged.fit = fit_jointly(train, from, law.parameters, 2 * state.settings->iterations, false);
    if (!judged.fit.ok) return std::nullopt;
  }
  const Model& model = judged.fit.model;
  FitData train = smoothed_comparison(data.train, model, data.window_s, shown.train_N);
  FitData validation = smoothed_comparison(data.validation, model, data.window_s, shown.validation_N);
  const Misfit misfit = estimate_misfit(train, model);
  add_misfit(train, misfit);
  add_misfit(validation, misfit);
  judged.train = deviance(train, model);
  judged.validation = deviance(validation, model);
  return judged;
}

// The likelier of the law and of the same with shorter paths before sliding: at noisy positions a long path passes less
// of their noise on, and from there no fit comes back.
std::optional<Judged> judge_by_every_path(const SearchState& state, const Law& law, const Shown& shown, int rounds) {
  std::optional<Judged> best = judge(state, law, shown, rounds);
  for (Model& shorter : with_shorter_paths(law.model)) {
    auto judged = judge(state, {std::move(shorter), law.parameters}, shown, rounds);
    if (judged && (!best || judged->train < best->train)) best = std::move(judged);
  }
  return best;
}

// What the larger law must gain: more than in the simulated recordings in which the smaller one is the truth, and at
// least `least`. Infinite where too few of them could be judged: a bar that is missing is not passed. Where a few of
// them leave no doubt about `gain`, no more are asked.
double likelihood_bar(const SearchState& state, const Law& smaller, const Law& larger, double least, double gain) {
  const SearchData& data = *state.data;
  const auto shown_in = [&](const Evidence& evidence, const FitData& blocks, std::size_t world) {
    const Prediction nominal = evidence.predictor->predict(smaller.model);
    return block_means(blocks.blocks, evidence.noise->null_forces(smaller.model, nominal, world));
  };
  std::vector<double> usable;
  const auto ask = [&](std::size_t first, std::size_t last) {
    std::vector<std::optional<double>> gains(last - first);
    const auto in_world = [&](std::size_t i) {
      const std::size_t world = first + i;
      const Shown shown{shown_in(data.train, state.train, world), shown_in(data.validation, state.validation, world)};
      const auto a = judge(state, smaller, shown, 2);
      const auto b = judge(state, larger, shown, 2);
      if (a && b) gains[i] = std::min(a->train - b->train, a->validation - b->validation);
    };
    in_parallel(gains.size(), in_world, 1);
    for (const auto& one : gains) {
      if (one) usable.push_back(*one);
    }
  };
  const auto bar = [&] { return std::max(least, bar_above(usable, state.settings->null_deviations)); };
  ask(0, few_worlds);
  const bool enough = usable.size() >= fewest_worlds;
  if (!enough || !is_clear(gain, bar())) ask(few_worlds, NoiseModel::null_simulations);
  // Fits that ended with the time are no bar.
  const bool judged_all = usable.size() >= fewest_worlds && state.budget->allows("a bar for likelihoods");
  return judged_all ? bar() : std::numeric_limits<double>::infinity();
}

// The model with the candidate in the place of one of its effects.
std::optional<Law> with_larger(const SearchState& state, const std::string& smaller,
                               const rendering::Candidate& candidate) {
  const Model rest = without_entry(state.current.model, smaller);
  const CandidateFit options = state.options(candidate, rest);
  const auto kept = without_owner(state.compared(), smaller);
  JointFit fit = best_fit(state.train, rest, options, kept, state.settings->iterations);
  if (!fit.ok) return std::nullopt;
  return Law{std::move(fit.model), joined(kept, options.parameters)};
}

// The smaller law from where the larger one's fit ended, as far as they have parameters of one name: the residual of
// the difference is the laws' and not that of two fits.
std::optional<Judged> judge_special_case(const SearchState& state, const Law& now, const std::string& smaller,
                                         const Model& larger_model, const std::string& larger, const Shown& shown,
                                         int rounds) {
  Law special{without_entry(larger_model, larger), now.parameters};
  rendering::NamedParameters entry = *find_entry(now.model, smaller);
  for (const auto& [name, value] : find_entry(larger_model, larger)->parameters) {
    const auto shared = entry.parameters.find(name);
    if (shared != entry.parameters.end()) shared->second = value;
  }
  special.model.effects.push_back(std::move(entry));
  return judge(state, special, shown, rounds);
}

// How far apart two models' forces are where they are most: the share of the force that 2 % of the validation blocks in
// contact exceed.
double most_apart(const SearchState& state, const Model& a, const Model& b) {
  Predictor& predictor = state.data->validation.noise->likely_predictor();
  const auto of_a = block_means(state.validation.blocks, predictor.predict(a).f_W_N);
  const auto of_b = block_means(state.validation.blocks, predictor.predict(b).f_W_N);
  std::vector<double> shares;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    if (state.validation.noise[i].n_W.isZero()) continue;
    shares.push_back((of_a[i] - of_b[i]).norm() / std::max(of_a[i].norm(), state.data->force_floor_N));
  }
  return shares.empty() ? 0.0 : stats::lower_quantile(std::move(shares), 0.98);
}

// What the larger law changes, as a share of what the smaller one does.
double changes(const SearchState& state, const Model& smaller_model, const std::string& smaller,
               const Model& larger_model) {
  return most_apart(state, smaller_model, larger_model) /
         std::max(most_apart(state, smaller_model, without_entry(smaller_model, smaller)), 1e-12);
}

// Why a coefficient that falls with speed is not to take the place of a steady one; "" where it is.
std::string stays_in_cone(const SearchState& state, const std::string& smaller) {
  const SearchSettings& settings = *state.settings;
  const Model& model = state.current.model;
  const Model others = without_entry(model, smaller);
  for (const auto& [side, blocks] :
       {std::pair(&state.data->train, &state.train), std::pair(&state.data->validation, &state.validation)}) {
    const ConeEvidence evidence = cone_evidence(*blocks, *side->noise, others, state.data->force_floor_N);
    const auto cone = cone_of(cone_samples(evidence, side->recording->f_W_N));
    const auto nulls = null_excesses(evidence, *side->noise, model, side->predictor->predict(model));
    if (!cone || nulls.size() < fewest_worlds) return "too little contact to tell whether friction falls with speed";
    const double bar = std::max(settings.cone_excess, bar_above(nulls, settings.null_deviations));
    if (!(cone->excess() > bar)) {
      return fmt::format(
          "forces leave the cone of fast sliding by {:.0f} % of its coefficient; noise and {} by {:.0f} %",
          100.0 * cone->excess(), smaller, 100.0 * bar);
    }
  }
  return "";
}

// The mean square of the force error that noise leaves in each phase on the smoothed trajectory where `model` is the
// truth, by simulated recordings.
std::map<std::string, double> noise_squares(const SearchState& state, const Model& model) {
  Evidence evidence = state.data->validation;
  const Prediction nominal = evidence.predictor->predict(model);
  const Prediction likely = evidence.noise->likely_predictor().predict(model);
  std::map<std::string, double> squares;
  for (std::size_t world = 0; world < few_worlds; ++world) {
    recording::Recording shown = *evidence.recording;
    shown.f_W_N = evidence.noise->null_forces(model, nominal, world);
    evidence.recording = &shown;
    for (const Regime& regime : sort_by_regime(evidence, likely, likely, state.data->force_floor_N)) {
      if (regime.kind == RegimeKind::phase) squares[regime.name] += regime.after_N * regime.after_N / few_worlds;
    }
    evidence.recording = state.data->validation.recording;
  }
  return squares;
}

// The phase that the model makes worse on the smoothed trajectory, by the path of its friction and by shorter ones; ""
// for none. A path that noise has made too long lags like a sensor, so that with the lag found the two together are too
// late. What noise leaves where each model is the truth is no error of it: a tip under a short path shows more of it.
std::string worsened_by_every_path(const SearchState& state, const Model& baseline, const Model& model) {
  const Evidence& evidence = state.data->validation;
  Predictor& likely = evidence.noise->likely_predictor();
  const Prediction before = likely.predict(baseline);
  const auto noise_before = noise_squares(state, baseline);
  const auto beyond = [](double error_N, const std::map<std::string, double>& noise, const std::string& phase) {
    const auto left = noise.find(phase);
    return std::sqrt(std::max(0.0, error_N * error_N - (left == noise.end() ? 0.0 : left->second)));
  };
  const auto regimes_of = [&](const Model& variant) {
    auto regimes = sort_by_regime(evidence, before, likely.predict(variant), state.data->force_floor_N);
    const auto noise_after = noise_squares(state, variant);
    for (Regime& regime : regimes) {
      if (regime.kind != RegimeKind::phase) continue;
      regime.before_N = beyond(regime.before_N, noise_before, regime.name);
      regime.after_N = beyond(regime.after_N, noise_after, regime.name);
    }
    return regimes;
  };
  auto least = regimes_of(model);
  for (const Model& shorter : with_shorter_paths(model)) {
    const auto regimes = regimes_of(shorter);
    for (std::size_t i = 0; i < least.size() && i < regimes.size(); ++i) {
      if (regimes[i].name == least[i].name) least[i].after_N = std::min(least[i].after_N, regimes[i].after_N);
    }
  }
  return worsened_phase(least, state.settings->worsening);
}

}  // namespace

std::vector<LargerLaw> weigh_larger_laws(const SearchState& state) {
  const SearchSettings& settings = *state.settings;
  const Shown measured{state.train.measured_N, state.validation.measured_N};
  const Law now{state.current.model, state.compared()};
  constexpr int rounds = 4;
  std::optional<Judged> baseline;
  std::vector<LargerLaw> laws;
  for (const rendering::NamedParameters& entry : state.current.model.effects) {
    for (const rendering::Candidate& candidate : *state.candidates) {
      if (!state.library().contains(candidate.name, entry.name) || is_field(candidate.parameters) ||
          !state.budget->allows(candidate.name + " in place of " + entry.name)) {
        continue;
      }
      if (!baseline) baseline = judge(state, now, measured, rounds);
      if (!baseline) return laws;
      const auto larger = with_larger(state, entry.name, candidate);
      const auto judged = larger ? judge(state, *larger, measured, rounds) : std::nullopt;
      if (!judged) continue;
      const auto again =
          judge_special_case(state, now, entry.name, judged->fit.model, candidate.name, measured, rounds);
      const Judged& special = again && again->train < baseline->train ? *again : *baseline;
      Trial trial;
      trial.name = candidate.name;
      trial.side = candidate.side;
      trial.fit = judged->fit;
      trial.parameters = larger->parameters;
      trial.train_gain = special.train - judged->train;
      trial.validation_gain = special.validation - judged->validation;
      trial.deviance = judged->validation;
      trial.validation_rms_N = state.validation_rms_N(trial.fit.model);
      const double gain = std::min(trial.train_gain, trial.validation_gain);
      // Both as fitted by likelihood, which at the noisy positions leaves more than a fit there does.
      const double smaller_N =
          std::max(state.validation_rms_N(state.current.model), state.validation_rms_N(special.fit.model));
      if (candidate.traits.velocity_weakening) {
        trial.verdict = stays_in_cone(state, entry.name);
      } else if (trial.validation_rms_N > smaller_N) {
        trial.verdict = "its validation error is larger than that of " + entry.name + ", which it contains";
      } else if (!(gain >= settings.law_gain)) {
        trial.verdict = "no more likely than " + entry.name + ", which it contains";
      } else if (!(changes(state, special.fit.model, entry.name, trial.fit.model) >= settings.law_change)) {
        trial.verdict = "changes " + entry.name + ", which it contains, by less than laws are idealized";
      } else {
        trial.null_threshold = likelihood_bar(state, {special.fit.model, now.parameters},
                                              {trial.fit.model, trial.parameters}, settings.law_gain, gain);
        if (!(gain > trial.null_threshold)) trial.verdict = within_null;
      }
      laws.push_back({entry.name, std::move(trial)});
    }
  }
  std::sort(laws.begin(), laws.end(), [](const LargerLaw& a, const LargerLaw& b) {
    return std::pair(!a.trial.verdict.passed(), a.trial.deviance) <
           std::pair(!b.trial.verdict.passed(), b.trial.deviance);
  });
  return laws;
}

bool likelier_in_place(const SearchState& state, const Model& with_other,
                       const std::vector<FreeParameter>& parameters) {
  const Shown measured{state.train.measured_N, state.validation.measured_N};
  const Law now{state.current.model, state.compared()};
  constexpr int rounds = 3;
  const auto baseline = judge(state, now, measured, rounds);
  const auto other = judge(state, {with_other, parameters}, measured, rounds);
  if (!baseline || !other) return false;
  const double gain = std::min(baseline->train - other->train, baseline->validation - other->validation);
  const double least = state.settings->law_gain;
  return gain >= least && gain > likelihood_bar(state, {baseline->fit.model, now.parameters},
                                                {other->fit.model, parameters}, least, gain);
}

std::vector<Trial> weigh_by_likelihood(const SearchState& state, const std::vector<Trial>& trials) {
  const SearchSettings& settings = *state.settings;
  const SearchData& data = *state.data;
  const Evidence& evidence = data.validation;
  Predictor& likely = evidence.noise->likely_predictor();
  const Shown measured{state.train.measured_N, state.validation.measured_N};
  const Law now{state.current.model, state.compared()};
  constexpr int rounds = 3;
  const auto baseline = judge_by_every_path(state, now, measured, rounds);
  std::vector<Trial> passed;
  if (!baseline) return passed;
  const Prediction before = likely.predict(baseline->fit.model);
  const double before_N = rms_force_error_N(evidence, before);
  const double noisy_N = state.validation_rms_N(state.current.model);
  const auto matters = [&](double without_N, double with_N) {
    return without_N * without_N - with_N * with_N >= settings.minimum_share * without_N * without_N;
  };
  const double deviance_now = state.validation_deviance(state.current.model);
  const bool beside_path = has_path(state.current.model);
  for (const Trial& tried : trials) {
    const bool hides =
        state.library().traits(tried.name).follows_speed || has_path(*find_entry(tried.fit.model, tried.name));
    // Beside a path that noise has made too long nothing that delays the force gains at noisy positions.
    const bool gains =
        beside_path || std::max(tried.train_gain, deviance_now - tried.deviance) >= settings.minimum_gain;
    if (!hides || !gains) continue;
    if (!state.budget->allows(tried.name + " on the smoothed trajectory")) continue;
    const auto judged = judge_by_every_path(state, {tried.fit.model, tried.parameters}, measured, rounds);
    if (!judged) continue;
    Trial trial = tried;
    trial.fit = judged->fit;
    trial.train_gain = baseline->train - judged->train;
    trial.validation_gain = baseline->validation - judged->validation;
    trial.deviance = judged->validation;
    const double gain = std::min(trial.train_gain, trial.validation_gain);
    if (!(gain >= settings.minimum_gain)) continue;
    const Prediction after = likely.predict(trial.fit.model);
    const double after_N = rms_force_error_N(evidence, after);
    // A tip that rests leaves much that no law takes away, at noisy positions less than on the smoothed trajectory or
    // more. By chi-squared those blocks count little.
    const FitData blocks = smoothed_comparison(data.validation, trial.fit.model, data.window_s, measured.validation_N);
    const bool shares = chi_squared(blocks, trial.fit.model) <=
                        (1.0 - settings.minimum_share) * chi_squared(blocks, baseline->fit.model);
    if (!shares && !matters(before_N, after_N) && !matters(noisy_N, tried.validation_rms_N)) continue;
    if (!worsened_by_every_path(state, baseline->fit.model, trial.fit.model).empty()) continue;
    trial.null_threshold = likelihood_bar(state, {baseline->fit.model, now.parameters},
                                          {trial.fit.model, trial.parameters}, settings.minimum_gain, gain);
    if (gain > trial.null_threshold) passed.push_back(std::move(trial));
  }
  // A law that contains another one that passed must be more likely than that.
  std::vector<Trial> chosen;
  std::copy_if(passed.begin(), passed.end(), std::back_inserter(chosen), [&](const Trial& large) {
    return std::none_of(passed.begin(), passed.end(), [&](const Trial& small) {
      return state.library().contains(large.name, small.name) &&
             !(std::min(large.train_gain - small.train_gain, large.validation_gain - small.validation_gain) >=
               settings.law_gain);
    });
  });
  std::sort(chosen.begin(), chosen.end(), [](const Trial& a, const Trial& b) { return a.deviance < b.deviance; });
  return chosen;
}

}  // namespace touchstone::discrepancy
