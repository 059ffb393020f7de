#include "harness/discrepancy/rivals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/nested_law.h"
#include "harness/discrepancy/smoothed_comparison.h"
#include "harness/discrepancy/trial_gates.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;
using rendering::Side;

namespace {

using Report = std::function<void(const std::string&)>;

// Whether the rival does as well as the found model on the smoothed trajectory, each fitted to it; or, where that is
// enough, differs there from it by less than an effect must be to be claimed.
bool alike_without_noise(const SearchState& state, const Model& rival, const std::vector<FreeParameter>& kept,
                         const rendering::Candidate& candidate, bool needs_close, const Report& report) {
  const SearchData& data = *state.data;
  const SearchSettings& settings = *state.settings;
  FitData validation = state.validation;
  const auto own = fit_data(data.validation, rival, data.window_s).noise;
  for (std::size_t b = 0; b < own.size(); ++b) {
    validation.noise[b].along_normal_N = std::max(validation.noise[b].along_normal_N, own[b].along_normal_N);
    validation.noise[b].tangential_N = std::max(validation.noise[b].tangential_N, own[b].tangential_N);
  }
  const auto parameters = joined(kept, state.options(candidate, state.current.model).parameters);
  const auto compared = state.compared();
  const auto loss = compare_smoothed(data, state.train, validation, {&state.current.model, &compared},
                                     {&rival, &parameters}, settings.iterations);
  if (!loss) return false;
  const double floor_N = expected_noise_N(data.validation, state.current.model);
  report(fmt::format("    {} on the smoothed trajectory: loses {:.0f} +- {:.0f}, {:.4g} N apart, noise {:.4g} N",
                     candidate.name, loss->lost, loss->error, loss->apart_N, floor_N));
  const bool close = loss->lost < std::max(settings.alike_errors * loss->error, settings.minimum_gain / 3.0);
  return loss->apart_N < (close ? 1.0 : needs_close ? 0.0 : settings.apart_share) * floor_N;
}

// What is free with the rival in the place of the loser.
std::vector<FreeParameter> with_rival(const SearchState& state, const Rival& rival, const std::string& loser) {
  const Model rest = without_entry(state.current.model, loser);
  return joined(without_owner(state.compared(), loser), state.options(state.candidate(rival.name), rest).parameters);
}

bool does_better_without_noise(const SearchState& state, const Rival& rival, const std::string& loser) {
  const auto parameters = with_rival(state, rival, loser);
  const auto compared = state.compared();
  const auto loss = compare_smoothed(*state.data, state.train, state.validation, {&state.current.model, &compared},
                                     {&rival.model, &parameters}, state.settings->iterations);
  return !loss || loss->lost < 0.0;
}

bool is_likelier(const SearchState& state, const Rival& rival, const std::string& loser) {
  return state.budget->allows(rival.name + " in place of " + loser + ", by likelihood") &&
         likelier_in_place(state, rival.model, with_rival(state, rival, loser));
}

// Whether the model without one of its effects has no place for the candidate: it is there, or what contains it is, or
// what it contains.
bool conflicts_with_model(const SearchState& state, const Model& rest, const std::string& name) {
  return find_entry(state.current.model, name) != nullptr || state.library().has_what_contains(rest, name) ||
         state.library().without_special_cases(rest, name).effects.size() < rest.effects.size();
}

// What rivals of one effect are compared with.
struct Incumbent {
  const FoundEffect& found;
  std::vector<FreeParameter> kept;  // without the effect's
  JointFit bare;                    // the model without it
  Model rest;                       // the same without a fit
  std::vector<double> here;         // chi-squared of the validation blocks
  std::vector<double> deviances;    // of the same
  double here_N = 0.0;
  double floor_N = 0.0;
  double abandon_above =
      0.0;  // chi-squared of the training blocks: a rival that stays above it makes up for next to nothing
};

// A tenth of what the effect explains there.
double explains_next_to_nothing(const SearchState& state, const JointFit& bare) {
  constexpr double share = 0.1;
  const double without = chi_squared(state.train, bare.model);
  const double prior = bare.chi_squared - without;  // of fields; the fits of rivals have it too
  const double explained = without - chi_squared(state.train, state.current.model);
  if (!(explained > state.settings->minimum_gain)) return std::numeric_limits<double>::infinity();
  return prior + without - share * explained;
}

std::optional<Rival> weigh(const SearchState& state, const Incumbent& incumbent, const rendering::Candidate& other,
                           const WarmStart& warm_start, const DecidedPairs& decided, const Report& report) {
  const SearchSettings& settings = *state.settings;
  const FoundEffect& found = incumbent.found;
  if (is_field(other.parameters) || conflicts_with_model(state, incumbent.rest, other.name)) return std::nullopt;
  if (!state.budget->allows(other.name + " in place of " + found.name)) return std::nullopt;
  // From what is known of the rest, which `bare` had to bend to make up for what it lacks.
  CandidateFit starting = state.options(other, incumbent.bare.model);
  if (const NamedParameters* const tried = warm_start(other.name, found.name)) starting.starts.push_back(*tried);
  // To the end, unless it is clear that it makes up for next to nothing: a rival must lose by its evidence, not by a
  // fit that was broken off.
  const JointFit fit = best_fit(state.train, incumbent.rest, starting, incumbent.kept,
                                FitEffort{3 * settings.iterations, settings.iterations / 3, incumbent.abandon_above});
  if (!fit.ok) return std::nullopt;
  Rival rival;
  rival.name = other.name;
  rival.side = other.side;
  rival.model = fit.model;
  std::tie(rival.validation_gain_lost, rival.error) =
      paired_difference(block_chi_squared(state.validation, fit.model), incumbent.here);
  std::tie(rival.log_likelihood_gain, rival.likelier_error) =
      paired_difference(incumbent.deviances, state.block_deviances(fit.model).validation);
  const double lost = rival.validation_gain_lost;
  rival.validation_rms_N = state.validation_rms_N(fit.model);
  const bool close = lost < settings.alike_errors * rival.error || lost < settings.minimum_gain / 3.0;
  const EffectLibrary library = state.library();
  rival.contains_found = library.contains(other.name, found.name);
  rival.special_case = library.contains(found.name, other.name);
  rival.of_settled_kind = (decided.laws.contains(found.name) && library.of_one_kind(found.name, other.name)) ||
                          decided.places.contains({found.name, other.name});
  if (rival.of_settled_kind) return rival;
  if (lost < settings.rival_gain * found.validation_gain && !rival.contains_found && !rival.special_case) {
    // Many units of chi-squared from a few runs have a large error and tell all the same.
    const double more_N =
        std::sqrt(std::max(0.0, rival.validation_rms_N * rival.validation_rms_N - incumbent.here_N * incumbent.here_N));
    const bool near = lost < settings.alike_gain * found.validation_gain;
    rival.indistinguishable = (near && close && more_N < incumbent.floor_N) ||
                              alike_without_noise(state, rival.model, incumbent.kept, other, !near, report);
  }
  return rival;
}

std::vector<Rival> weigh_all(const SearchState& state, const Incumbent& incumbent, const WarmStart& warm_start,
                             const DecidedPairs& decided, const Report& report) {
  const std::size_t count = state.candidates->size();
  std::vector<std::optional<Rival>> weighed(count);
  std::vector<std::string> said(count);
  const auto one = [&](std::size_t i) {
    weighed[i] = weigh(state, incumbent, (*state.candidates)[i], warm_start, decided,
                       [&](const std::string& text) { said[i] = text; });
  };
  in_parallel(count, one, 1);
  std::vector<Rival> rivals;
  for (std::size_t i = 0; i < count; ++i) {
    if (!said[i].empty()) report(said[i]);
    if (weighed[i]) rivals.push_back(std::move(*weighed[i]));
  }
  std::sort(rivals.begin(), rivals.end(),
            [](const Rival& a, const Rival& b) { return a.validation_gain_lost < b.validation_gain_lost; });
  return rivals;
}

// Whether the rival does as well at the recorded positions and on the smoothed trajectory with less than half of the
// parameters: then it is the likelier of the two (Jefferys and Berger 1992), though the data cannot tell.
bool simpler_and_alike(const SearchState& state, const FoundEffect& found, const Rival& rival) {
  if (!rival.indistinguishable || !(rival.validation_gain_lost < state.settings->minimum_gain / 3.0)) return false;
  const Model rest = without_entry(state.current.model, found.name);
  const auto count = [&](const std::string& name) {
    return state.options(state.candidate(name), rest).parameters.size();
  };
  return 2 * count(rival.name) < count(found.name);
}

bool gains_clearly(const SearchSettings& settings, double gain, double error) {
  return gain >= std::max(settings.minimum_gain, settings.alike_errors * error);
}

// By the found model's weights, or by the likelihood: those weights count what the found model lacks as noise, so that
// the residual of a few blocks hides all others, where the rival leaves little.
bool clearly_better(const SearchSettings& settings, const Rival& rival) {
  const auto clear = [&](double gain, double error) { return gains_clearly(settings, gain, error); };
  return clear(-rival.validation_gain_lost, rival.error) || clear(rival.log_likelihood_gain, rival.likelier_error);
}

}  // namespace

std::vector<FoundEffect> weigh_rivals(const SearchState& state, const WarmStart& warm_start,
                                      const DecidedPairs& decided, const Report& report) {
  std::vector<FoundEffect> all;
  const auto here = block_chi_squared(state.validation, state.current.model);
  const auto deviances = state.block_deviances(state.current.model).validation;
  const double here_N = state.validation_rms_N(state.current.model);
  const double floor_N = expected_noise_N(state.data->validation, state.current.model);
  std::vector<std::pair<std::string, Side>> names;
  for (const NamedParameters& entry : state.current.model.effects) names.emplace_back(entry.name, Side::contact);
  for (const NamedParameters& entry : state.current.model.instrument) names.emplace_back(entry.name, Side::instrument);
  for (const auto& [name, side] : names) {
    report(fmt::format("  rivals of {}", name));
    FoundEffect found;
    found.name = name;
    found.side = side;
    const auto kept = without_owner(state.compared(), name);
    const JointFit bare =
        fit_jointly(state.train, without_entry(state.current.model, name), kept, state.settings->iterations, false);
    if (!bare.ok) continue;
    found.validation_gain =
        chi_squared(state.validation, bare.model) - chi_squared(state.validation, state.current.model);
    found.rivals = weigh_all(state,
                             {found, kept, bare, without_entry(state.current.model, name), here, deviances, here_N,
                              floor_N, explains_next_to_nothing(state, bare)},
                             warm_start, decided, report);
    all.push_back(std::move(found));
  }
  return all;
}

Swap best_swap(const SearchState& state, const std::vector<FoundEffect>& found, const std::set<std::string>& put_away) {
  Swap best;
  Swap log_likelihood_z;
  for (const FoundEffect& effect : found) {
    for (const Rival& rival : effect.rivals) {
      if (put_away.contains(rival.name) || rival.of_settled_kind) continue;
      // A larger law that came back after it was put away has shown that it is needed.
      const bool needless = rival.special_case && !put_away.contains(effect.name) &&
                            !gains_clearly(*state.settings, rival.validation_gain_lost, rival.error);
      if (needless || simpler_and_alike(state, effect, rival)) return {&effect, &rival};
      // A law with more parameters gains a little always: whether it acts is asked elsewhere (nested_law.h).
      if (rival.contains_found || within_mesh_error(state, rival.model, rival.name)) continue;
      if (!clearly_better(*state.settings, rival)) {
        if (log_likelihood_z.winner == nullptr && rival.indistinguishable && is_likelier(state, rival, effect.name))
          log_likelihood_z = {&effect, &rival, true};
        continue;
      }
      if (!does_better_without_noise(state, rival, effect.name)) continue;
      if (best.winner == nullptr || rival.log_likelihood_gain > best.winner->log_likelihood_gain)
        best = {&effect, &rival};
    }
  }
  return best.winner == nullptr ? log_likelihood_z : best;
}

}  // namespace touchstone::discrepancy
