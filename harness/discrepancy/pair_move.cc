#include "harness/discrepancy/pair_move.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/trial_gates.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

constexpr std::size_t most_firsts = 3;
constexpr std::size_t most_pairs = 4;  // that compete to the end

// By training gain; of laws that contain each other the better alone.
std::vector<Trial> best_by_training(std::vector<Trial> singles, const EffectLibrary& library) {
  std::sort(singles.begin(), singles.end(), [](const Trial& a, const Trial& b) { return a.train_gain > b.train_gain; });
  std::vector<Trial> firsts;
  for (const Trial& trial : singles) {
    if (!(trial.train_gain > 0.0) || firsts.size() == most_firsts) break;
    const bool related = std::any_of(firsts.begin(), firsts.end(),
                                     [&](const Trial& first) { return library.of_one_kind(first.name, trial.name); });
    if (!related) firsts.push_back(trial);
  }
  return firsts;
}

// The second's trial in the state where the first is known, as a pair seen from the state where neither is.
Trial paired(const SearchState& state, const BaselineScore& baseline, const Trial& first, const Trial& second) {
  Trial pair = second;
  pair.name = first.name;
  pair.partner = second.name;
  pair.side = first.side;
  pair.verdict = {};
  JointFit fit = fit_jointly(state.train, Model(second.fit.model), pair.parameters, state.settings->iterations, false);
  if (fit.ok) pair.fit = std::move(fit);
  pair.fit.chi_squared = chi_squared(state.train, pair.fit.model);
  score(state, baseline, pair);
  return pair;
}

// Two that happen to bend the right way together always gain a little: a pair must be most of what is missing.
bool is_most_of_what_is_missing(const SearchState& state, const BaselineScore& baseline, const Trial& pair) {
  const double noise_N = expected_noise_N(state.data->validation, pair.fit.model);
  const double before = baseline.validation_rms_N * baseline.validation_rms_N;
  const double after = pair.validation_rms_N * pair.validation_rms_N;
  return before - after >= state.settings->pair_share * (before - noise_N * noise_N);
}

// Every pair whose second effect is more than noise on what the first leaves, and that is most of what is missing; the
// least deviance first.
std::vector<Trial> competing_pairs(const SearchState& state, const BaselineScore& baseline,
                                   const std::vector<Trial>& firsts) {
  std::vector<Trial> pairs;
  for (const Trial& first : firsts) {
    if (!state.budget->allows(first.name + " in pairs of effects")) continue;
    const SearchState known = with_trial(state, first);
    const BaselineScore left = baseline_score(known);
    for (const Trial& second : try_candidates(known, left)) {
      // Two laws of dry friction at once are one law that the library does not have.
      if (state.library().of_one_kind(second.name, first.name) || !cheap_gates(known, left, second).passed()) continue;
      Trial pair = paired(state, baseline, first, second);
      if (is_most_of_what_is_missing(state, baseline, pair)) pairs.push_back(std::move(pair));
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Trial& a, const Trial& b) { return a.deviance < b.deviance; });
  // The same two in either order: the better fit.
  std::set<std::set<std::string>> seen;
  std::erase_if(pairs, [&](const Trial& pair) { return !seen.insert({pair.name, pair.partner}).second; });
  if (pairs.size() > most_pairs) pairs.resize(most_pairs);
  return pairs;
}

// Whether `name` earns its place beside `other`, which is assumed known.
TrialVerdict refusal_of_member(const SearchState& state, const Trial& other, const std::string& name) {
  const SearchState known = with_trial(state, other);
  const BaselineScore left = baseline_score(known);
  auto trial = try_candidate(known, left, state.candidate(name));
  return trial ? all_gates(known, left, *trial) : "no fit of it beside the other is usable";
}

}  // namespace

std::vector<Trial> try_pairs(const SearchState& state, const BaselineScore& baseline,
                             const std::vector<Trial>& singles) {
  std::vector<Trial> pairs = competing_pairs(state, baseline, best_by_training(singles, state.library()));
  const auto alone = [&](const std::string& name) {
    return std::find_if(singles.begin(), singles.end(), [&](const Trial& t) { return t.name == name; });
  };
  const auto compared = state.compared();
  // The maximum over all that compete, in simulated recordings without either effect.
  const auto refits = [&](const FitData& train, const recording::Recording& recording, const Model& base) {
    std::vector<JointFit> fits;
    std::map<std::string, JointFit> alone_here;
    for (const Trial& pair : pairs) {
      const int iterations = state.settings->iterations;
      const CandidateFit first = state.options(state.candidate(pair.name), base, recording);
      const auto [one, unknown] = alone_here.try_emplace(pair.name);
      if (unknown) one->second = best_fit(train, base, first, compared, iterations);
      if (!one->second.ok) continue;
      const Model& with_first = one->second.model;
      const CandidateFit second = state.options(state.candidate(pair.partner), with_first, recording);
      fits.push_back(best_fit(train, with_first, second, joined(compared, first.parameters), iterations));
    }
    return fits;
  };
  bool passed = false;
  for (Trial& pair : pairs) {
    if (passed) {
      pair.verdict = "not judged: a better pair passed";
      continue;
    }
    if (!state.budget->allows("the checks of " + pair.title())) {
      pair.verdict = out_of_time;
      continue;
    }
    pair.verdict = cheap_gates(state, baseline, pair);
    if (pair.verdict.passed()) pair.verdict = costly_gates(state, pair);
    for (const auto& [name, other] : {std::pair(pair.name, pair.partner), std::pair(pair.partner, pair.name)}) {
      if (!pair.verdict.passed()) break;
      const auto known = alone(other);
      const TrialVerdict beside =
          known == singles.end() ? "it could not be fitted alone" : refusal_of_member(state, *known, name);
      if (!beside.passed()) pair.verdict = fmt::format("{} beside {}: {}", name, other, beside.words);
    }
    if (!pair.verdict.passed()) continue;
    pair.null_threshold = null_threshold(state, refits, pair.validation_gain);
    if (!state.budget->allows("the checks of " + pair.title())) {
      pair.verdict = out_of_time;
      continue;
    }
    passed = pair.validation_gain > pair.null_threshold;
    if (!passed) pair.verdict = within_null;
  }
  return pairs;
}

}  // namespace touchstone::discrepancy
