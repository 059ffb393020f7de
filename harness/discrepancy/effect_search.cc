#include "harness/discrepancy/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "harness/discrepancy/along_likely.h"
#include "harness/discrepancy/data_faults.h"
#include "harness/discrepancy/goodness.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/discrepancy/regimes.h"

namespace touchstone {
namespace {

std::vector<FreeParameter> joined(std::vector<FreeParameter> parameters, const std::vector<FreeParameter>& more) {
  parameters.insert(parameters.end(), more.begin(), more.end());
  return parameters;
}

class Search {
 public:
  Search(const SearchData& data, const std::vector<Candidate>& candidates, const SearchSettings& settings,
         const Report& report)
      : data_(data), candidates_(candidates), settings_(settings), report_(report) {}

  SearchResult run(const Model& start) {
    result_.start = start;
    parameters_ = {base_stiffness(start)};
    Prediction nothing;
    nothing.f_W_N.assign(data_.holdout.recording->size(), Vec3::Zero());
    holdout_force_N_ = rms_force_error_N(data_.holdout, nothing);
    renew_noise(start);
    current_ = fit_jointly(train_, start, parameters_, settings_.iterations, false);
    if (!current_.ok) current_.model = start;
    renew_noise(current_.model);
    refit();
    result_.base = current_.model;
    do {
      while (add_one()) {
      }
      drop_needless();
      weigh_rivals();
    } while (swap_one());
    finish();
    return std::move(result_);
  }

 private:
  // Noise follows the model: friction adds its own, damping too. What the model lacks counts as noise until it is
  // found.
  void renew_noise(const Model& model) {
    train_ = fit_data(data_.train, model, data_.window_s);
    holdout_ = fit_data(data_.holdout, model, data_.window_s);
    declared_train_ = train_;
    declared_holdout_ = holdout_;
    const Misfit misfit = estimate_misfit(train_, model);
    add_misfit(train_, misfit);
    add_misfit(holdout_, misfit);
  }

  // Under the noise of the current model and the misfit that the given one leaves on the training blocks.
  double holdout_deviance(const Model& model) const {
    FitData holdout = declared_holdout_;
    add_misfit(holdout, estimate_misfit(declared_train_, model));
    return deviance(holdout, model);
  }

  void refit() {
    JointFit fit = fit_jointly(train_, Model(current_.model), parameters_, settings_.iterations, false);
    if (fit.ok) current_ = std::move(fit);
  }

  double holdout_rms(const Model& model) const {
    return rms_force_error_N(data_.holdout, data_.holdout.predictor->predict(model));
  }

  const Candidate& candidate(const std::string& name) const {
    return *std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& c) { return c.name == name; });
  }

  CandidateFit options(const Candidate& candidate, const Model& model) const {
    return options(candidate, model, *data_.train.recording);
  }

  CandidateFit options(const Candidate& candidate, const Model& model, const Recording& recording) const {
    const Prediction now = data_.train.predictor->predict(model);
    // The start's stiffness: that of a model which hardly touches was fitted to nothing.
    const RecordingScales scales = measure_scales(
        recording, now, data_.force_floor_N, result_.start.parameters.at("stiffness_N_per_m"), data_.position_noise_m);
    return candidate_fit(candidate, scales, recording, now);
  }

  // Few worlds where they decide clearly, all of them where the gain is near the bar.
  double null_bar(const Candidate& candidate, double gain) const {
    constexpr std::size_t few = 4;
    constexpr double near = 3.0;
    const NullCase null{&data_.train, &data_.holdout,      &train_, &holdout_, &current_.model,
                        &parameters_, settings_.iterations};
    const auto enter = [&](const Model& model, const Recording& recording) {
      return options(candidate, model, recording);
    };
    auto gains = null_gains(null, enter, 0, few);
    double bar = std::max(settings_.minimum_gain, bar_above(gains, settings_.null_deviations));
    if (gain > near * bar || near * gain < bar) return bar;
    const auto more = null_gains(null, enter, few, NoiseModel::null_worlds);
    gains.insert(gains.end(), more.begin(), more.end());
    return std::max(settings_.minimum_gain, bar_above(gains, settings_.null_deviations));
  }

  bool add_one() {
    SearchStep step;
    step.train_chi_squared = chi_squared(train_, current_.model);
    const auto before = block_chi_squared(holdout_, current_.model);
    step.holdout_chi_squared = std::accumulate(before.begin(), before.end(), 0.0);
    step.holdout_rms_N = holdout_rms(current_.model);
    const std::size_t found = current_.model.effects.size() + current_.model.instrument.size();
    report_(fmt::format("step {}: held-out RMS {:.4g} N, chi-squared per degree of freedom {:.2f}", found + 1,
                        step.holdout_rms_N,
                        step.holdout_chi_squared / (3.0 * static_cast<double>(holdout_.blocks.size()))));
    for (const Candidate& candidate : candidates_) {
      if (find_entry(current_.model, candidate.name) != nullptr || has_what_contains(current_.model, candidate.name))
        continue;
      const Model rest = without_special_cases(current_.model, candidate.name);
      Trial trial;
      trial.name = candidate.name;
      trial.side = candidate.side;
      trial.fit = best_fit(train_, rest, options(candidate, rest), free_in(rest), settings_.iterations);
      if (!trial.fit.ok) continue;
      trial.train_gain = step.train_chi_squared - trial.fit.chi_squared;
      std::tie(trial.holdout_gain, trial.holdout_error) =
          paired_difference(before, block_chi_squared(holdout_, trial.fit.model));
      trial.holdout_rms_N = holdout_rms(trial.fit.model);
      trial.deviance = holdout_deviance(trial.fit.model);
      trial.verdict = weakness(trial, step);
      step.trials.push_back(std::move(trial));
    }
    std::sort(step.trials.begin(), step.trials.end(),
              [](const Trial& a, const Trial& b) { return a.deviance < b.deviance; });
    bool more = false;
    while (found < settings_.most_effects && !more) {
      verify_best(step);
      Trial* const best = preferred(step);
      if (best == nullptr) break;
      more = add(*best, step);
    }
    result_.steps.push_back(std::move(step));
    return more;
  }

  // The best of what passed; a special case that does as well is preferred to what contains it. nullptr: none passed.
  Trial* preferred(SearchStep& step) const {
    const auto best =
        std::find_if(step.trials.begin(), step.trials.end(), [](const Trial& t) { return t.verdict.empty(); });
    if (best == step.trials.end()) return nullptr;
    for (Trial& trial : step.trials) {
      if (trial.verdict.empty() && contains(best->name, trial.name) &&
          best->holdout_gain - trial.holdout_gain < settings_.alike_gain * 0.1 * best->holdout_gain + 10.0) {
        best->verdict = "no better than " + trial.name + ", which it contains";
        return &trial;
      }
    }
    return &*best;
  }

  // Adds the trial's effect; takes it back where the model, refitted under its own noise, does worse on held-out data.
  bool add(Trial& trial, SearchStep& step) {
    const auto parameters = parameters_;
    const JointFit before = current_;
    parameters_ = parameters_with(trial.name);
    current_ = trial.fit;
    renew_noise(current_.model);
    refit();
    if (holdout_rms(current_.model) < step.holdout_rms_N) {
      trial.verdict = "added";
      step.added = trial.name;
      report_(fmt::format("  {}: held-out RMS {:.4g} N", trial.name, holdout_rms(current_.model)));
      return true;
    }
    trial.verdict = "does worse on held-out data once all is refitted";
    parameters_ = parameters;
    current_ = before;
    renew_noise(current_.model);
    return false;
  }

  std::vector<FreeParameter> free_in(const Model& model) const {
    std::vector<FreeParameter> kept = parameters_;
    std::erase_if(kept, [&](const FreeParameter& parameter) {
      return find_entry(current_.model, parameter.owner) != nullptr && find_entry(model, parameter.owner) == nullptr;
    });
    return kept;
  }

  // The dear checks, of the best trial only; the next one's turn comes when it fails.
  void verify_best(SearchStep& step) const {
    const Prediction before = data_.holdout.predictor->predict(current_.model);
    for (Trial& trial : step.trials) {
      if (!trial.verdict.empty()) continue;
      const Prediction after = data_.holdout.predictor->predict(trial.fit.model);
      const std::string worse =
          worsened_phase(sort_by_regime(data_.holdout, before, after, data_.force_floor_N), settings_.worsening);
      if (!worse.empty()) {
        trial.verdict = fmt::format("makes {} worse", worse);
        continue;
      }
      if (!helps_without_noise(trial)) {
        trial.verdict = "helps at the noisy positions alone: it passes less of their noise on";
        continue;
      }
      if (!displaces_for_sure(trial)) {
        trial.verdict = "may be within the mesh's declared error";
        continue;
      }
      trial.null_bar = null_bar(candidate(trial.name), trial.holdout_gain);
      if (trial.holdout_gain > trial.null_bar) return;
      trial.verdict = "no more than noise and the mesh's declared error give where nothing is missing";
    }
  }

  std::vector<FreeParameter> parameters_with(const std::string& name) const {
    const Model rest = without_special_cases(current_.model, name);
    return joined(free_in(rest), options(candidate(name), rest).parameters);
  }

  // A bump or a texture of the mesh that is not there, by more than its makers declare.
  bool displaces_for_sure(const Trial& trial) const {
    if (!find_entry(trial.fit.model, trial.name)->parameters.contains("amplitude_m")) return true;
    const auto parameters = parameters_with(trial.name);
    const JointFit fit = fit_jointly(train_, trial.fit.model, parameters, settings_.iterations, true);
    return least_size95(fit, parameters, trial.name, "amplitude_m") > data_.geometry_error_m;
  }

  bool helps_without_noise(const Trial& trial) const {
    const auto parameters = parameters_with(trial.name);
    const auto loss = compare_along_likely(data_, train_, holdout_, {&trial.fit.model, &parameters},
                                           {&current_.model, &parameters_}, settings_.iterations);
    return !loss || loss->lost >= settings_.likely_share * trial.holdout_gain;
  }

  // Empty: strong enough to be added.
  std::string weakness(const Trial& trial, const SearchStep& step) const {
    if (trial.train_gain < settings_.minimum_gain) return "no more than noise on the training blocks";
    if (trial.holdout_gain < settings_.minimum_gain) return "no more than noise on the held-out blocks";
    if (trial.holdout_gain < settings_.gain_errors * trial.holdout_error) {
      return "its gain comes from a few held-out blocks alone";
    }
    const double removed = step.holdout_rms_N * step.holdout_rms_N - trial.holdout_rms_N * trial.holdout_rms_N;
    const bool shares = trial.holdout_gain >= settings_.minimum_share * step.holdout_chi_squared &&
                        removed >= settings_.minimum_share * step.holdout_rms_N * step.holdout_rms_N;
    const double noticed_N = settings_.just_noticeable_share * holdout_force_N_;
    if (!shares && removed < noticed_N * noticed_N) return "too small to matter";
    const NamedParameters& entry = *find_entry(trial.fit.model, trial.name);
    if (surface_displacement_m(entry, data_.train.recording->motion) <=
        settings_.mesh_margin * data_.geometry_error_m) {
      return "within the mesh's declared error";
    }
    return "";
  }

  // An effect that a later one made needless goes.
  void drop_needless() {
    std::vector<std::string> names;
    for (const auto* entries : {&current_.model.effects, &current_.model.instrument}) {
      for (const NamedParameters& entry : *entries) names.push_back(entry.name);
    }
    if (names.size() < 2) return;
    for (const std::string& name : names) {
      const auto kept = without_owner(parameters_, name);
      const JointFit fit = fit_jointly(train_, without_entry(current_.model, name), kept, settings_.iterations, false);
      const double here = chi_squared(holdout_, current_.model);
      if (!fit.ok ||
          chi_squared(holdout_, fit.model) - here > std::max(settings_.minimum_gain, settings_.minimum_share * here)) {
        continue;
      }
      report_(fmt::format("  {} is no longer needed", name));
      parameters_ = kept;
      current_ = fit;
      renew_noise(current_.model);
      refit();
    }
  }

  void weigh_rivals() {
    result_.found.clear();
    std::vector<std::pair<std::string, Side>> names;
    for (const NamedParameters& entry : current_.model.effects) names.emplace_back(entry.name, Side::contact);
    for (const NamedParameters& entry : current_.model.instrument) names.emplace_back(entry.name, Side::instrument);
    const auto here = block_chi_squared(holdout_, current_.model);
    const double here_N = holdout_rms(current_.model);
    const double floor_N = expected_noise_N(data_.holdout, current_.model);
    for (const auto& [name, side] : names) {
      report_(fmt::format("  rivals of {}", name));
      FoundEffect found;
      found.name = name;
      found.side = side;
      const auto kept = without_owner(parameters_, name);
      const JointFit bare = fit_jointly(train_, without_entry(current_.model, name), kept, settings_.iterations, false);
      if (!bare.ok) continue;
      const double bare_chi = chi_squared(holdout_, bare.model);
      found.holdout_gain = bare_chi - chi_squared(holdout_, current_.model);
      for (const Candidate& other : candidates_) {
        const Model rest = without_entry(current_.model, name);
        const bool one_too_many = has_what_contains(rest, other.name) ||
                                  without_special_cases(rest, other.name).effects.size() < rest.effects.size();
        if (find_entry(current_.model, other.name) != nullptr || one_too_many) continue;
        // From what is known of the rest, which `bare` had to bend to make up for what it lacks.
        CandidateFit starting = options(other, bare.model);
        if (const NamedParameters* const tried = came_to(other.name, name)) starting.starts.push_back(*tried);
        // To the end: a rival must lose by its evidence, not by a fit that was broken off.
        const JointFit fit = best_fit(train_, rest, starting, kept, 3 * settings_.iterations);
        if (!fit.ok) continue;
        Rival rival;
        rival.name = other.name;
        rival.side = other.side;
        rival.model = fit.model;
        const auto [lost, error] = paired_difference(block_chi_squared(holdout_, fit.model), here);
        rival.holdout_gain_lost = lost;
        rival.error = error;
        rival.holdout_rms_N = holdout_rms(fit.model);
        const bool close = lost < settings_.alike_errors * error || lost < settings_.minimum_gain / 3.0;
        const bool related = contains(other.name, name) || contains(name, other.name);
        if (lost < settings_.rival_gain * found.holdout_gain && !related) {
          // Many units of chi-squared from a few runs have a large error and tell all the same.
          const double more_N = std::sqrt(std::max(0.0, rival.holdout_rms_N * rival.holdout_rms_N - here_N * here_N));
          const bool near = lost < settings_.alike_gain * found.holdout_gain;
          rival.alike = (near && close && more_N < floor_N) || alike_without_noise(rival.model, kept, other, !near);
        }
        found.rivals.push_back(std::move(rival));
      }
      std::sort(found.rivals.begin(), found.rivals.end(),
                [](const Rival& a, const Rival& b) { return a.holdout_gain_lost < b.holdout_gain_lost; });
      result_.found.push_back(std::move(found));
    }
  }

  // What the rival came to when it competed with the effect that was added instead: a start that is near.
  const NamedParameters* came_to(const std::string& rival, const std::string& added) const {
    for (const SearchStep& step : result_.steps) {
      for (const Trial& trial : step.trials) {
        if (step.added == added && trial.name == rival) return find_entry(trial.fit.model, rival);
      }
    }
    return nullptr;
  }

  // Whether the rival does as well as the found model along the likely motion, each fitted to it; or, where that is
  // enough, differs there from it by less than an effect must be to be claimed.
  bool alike_without_noise(const Model& rival, const std::vector<FreeParameter>& kept, const Candidate& candidate,
                           bool needs_close) const {
    FitData holdout = holdout_;
    const auto own = fit_data(data_.holdout, rival, data_.window_s).noise;
    for (std::size_t b = 0; b < own.size(); ++b) {
      holdout.noise[b].along_normal_N = std::max(holdout.noise[b].along_normal_N, own[b].along_normal_N);
      holdout.noise[b].tangential_N = std::max(holdout.noise[b].tangential_N, own[b].tangential_N);
    }
    const auto parameters = joined(kept, options(candidate, current_.model).parameters);
    const auto loss = compare_along_likely(data_, train_, holdout, {&current_.model, &parameters_},
                                           {&rival, &parameters}, settings_.iterations);
    if (!loss) return false;
    const double floor_N = expected_noise_N(data_.holdout, current_.model);
    report_(fmt::format("    {} along the likely motion: loses {:.0f} +- {:.0f}, {:.4g} N apart, noise {:.4g} N",
                        candidate.name, loss->lost, loss->error, loss->apart_N, floor_N));
    const bool close = loss->lost < std::max(settings_.alike_errors * loss->error, settings_.minimum_gain / 3.0);
    return loss->apart_N < (close ? 1.0 : needs_close ? 0.0 : settings_.apart_share) * floor_N;
  }

  bool does_better_without_noise(const Rival& rival, const std::string& loser) const {
    const auto parameters = joined(without_owner(parameters_, loser),
                                   options(candidate(rival.name), without_entry(current_.model, loser)).parameters);
    const auto loss = compare_along_likely(data_, train_, holdout_, {&current_.model, &parameters_},
                                           {&rival.model, &parameters}, settings_.iterations);
    return !loss || loss->lost < 0.0;
  }

  // What stands in the place of a found effect and does better, now that the others are known, takes it. What was put
  // away does not come back, so that this ends.
  bool swap_one() {
    const Rival* best = nullptr;
    const FoundEffect* loser = nullptr;
    for (const FoundEffect& found : result_.found) {
      for (const Rival& rival : found.rivals) {
        const double clear = std::max(settings_.minimum_gain, settings_.alike_errors * rival.error);
        if (rival.holdout_gain_lost > -clear || put_away_.contains(rival.name)) continue;
        if (!does_better_without_noise(rival, found.name)) continue;
        if (best == nullptr || rival.holdout_gain_lost < best->holdout_gain_lost) {
          best = &rival;
          loser = &found;
        }
      }
    }
    if (best == nullptr) return false;
    report_(fmt::format("  {} in place of {}", best->name, loser->name));
    SearchStep step;
    step.train_chi_squared = chi_squared(train_, current_.model);
    step.holdout_chi_squared = chi_squared(holdout_, current_.model);
    step.holdout_rms_N = holdout_rms(current_.model);
    step.added = best->name;
    step.removed = loser->name;
    result_.steps.push_back(std::move(step));
    put_away_.insert(loser->name);
    parameters_ = joined(without_owner(parameters_, loser->name),
                         options(candidate(best->name), without_entry(current_.model, loser->name)).parameters);
    current_.model = best->model;
    renew_noise(current_.model);
    refit();
    return true;
  }

  // What a search counts as noise while something is missing is the same for all blocks of a group, and so takes weight
  // from the best of them: a tip that sticks shows the noise of its tracker, and in equal weight with one that slides
  // it would draw the coefficient of friction down. Values are fitted by the declared noise where that foretells the
  // held-out data better. Whether it did.
  bool settle_values() {
    JointFit sharp = fit_jointly(declared_train_, Model(result_.model), parameters_, 4 * settings_.iterations, true);
    if (!sharp.ok || chi_squared(declared_holdout_, sharp.model) >= chi_squared(declared_holdout_, result_.model)) {
      return false;
    }
    result_.fit = std::move(sharp);
    result_.model = result_.fit.model;
    return true;
  }

  void finish() {
    settle_texture(current_.model);
    result_.model = current_.model;
    result_.parameters = parameters_;
    result_.fit = fit_jointly(train_, Model(current_.model), parameters_, 4 * settings_.iterations, true);
    if (std::isfinite(result_.fit.chi_squared)) result_.model = result_.fit.model;
    const FitData& weights = settle_values() ? declared_train_ : train_;
    result_.draws = bootstrap_fits(data_.train, weights, result_.fit, parameters_, settings_.iterations / 2);
    // Whether noise is all that is left is judged by the declared noise.
    const Goodness goodness = judge_goodness(data_.train, data_.holdout, result_.model, data_.window_s);
    result_.goodness = goodness.chi_squared;
    result_.null_goodness = goodness.null;
    result_.noise_rms_N = goodness.noise_rms_N;
    const DetectorSide train{data_.train.recording, &goodness.train, data_.train.noise};
    const DetectorSide holdout{data_.holdout.recording, &goodness.holdout, data_.holdout.noise};
    result_.structure = detect_structure(train, holdout, result_.model, result_.draws);
    result_.data_fault = find_data_fault(train, holdout, result_.base, result_.model);
    if (result_.data_fault) {
      // Nothing is learnt from data that are wrong.
      result_.model = result_.base;
      result_.found.clear();
    }
  }

  const SearchData& data_;
  const std::vector<Candidate>& candidates_;
  const SearchSettings& settings_;
  const Report& report_;
  std::vector<FreeParameter> parameters_;
  FitData declared_train_;  // under the declared noise alone
  FitData declared_holdout_;
  FitData train_;  // with the current model's misfit
  FitData holdout_;
  JointFit current_;
  double holdout_force_N_ = 0.0;  // RMS of the measured force, held out
  std::set<std::string> put_away_;
  SearchResult result_;
};

}  // namespace

SearchResult search_effects(const SearchData& data, const Model& start, const std::vector<Candidate>& candidates,
                            const SearchSettings& settings, const Report& report) {
  return Search(data, candidates, settings, report).run(start);
}

}  // namespace touchstone
