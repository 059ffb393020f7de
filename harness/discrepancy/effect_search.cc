#include "harness/discrepancy/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "harness/discrepancy/data_faults.h"
#include "harness/discrepancy/field_move.h"
#include "harness/discrepancy/friction_cone.h"
#include "harness/discrepancy/goodness.h"
#include "harness/discrepancy/holdout_judgement.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/nested_law.h"
#include "harness/discrepancy/pair_move.h"
#include "harness/discrepancy/trial_gates.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;

namespace {

class Search {
 public:
  Search(const SearchData& data, const std::vector<rendering::Candidate>& candidates, const SearchSettings& settings,
         const Model& start, const Report& report)
      : data_(data), settings_(settings), report_(report), state_(data, candidates, settings, start) {}

  SearchResult run() {
    result_.start = state_.start;
    state_.refit(true);
    state_.renew_noise(state_.current.model);
    state_.refit(true);
    result_.base = state_.current.model;
    // Nothing can be learnt from blocks in a wrong order: the long work would be for nothing.
    result_.data_fault = order_fault(result_.base);
    if (!result_.data_fault) search();
    finish();
    return std::move(result_);
  }

 private:
  void search() {
    do {
      do {
        while (add()) continue;
      } while (extend_law() || add_field());
      drop_needless();
      result_.found = weigh_rivals(
          state_, [this](const std::string& rival, const std::string& added) { return warm_start(rival, added); },
          decided_, report_);
    } while (swap_one());
  }

  [[nodiscard]] SearchStep step_from(const BaselineScore& baseline) const {
    return {baseline.train_chi_squared, baseline.validation_chi_squared, baseline.validation_rms_N, {}, {}, {}};
  }

  // One effect, or two where no single one passes though something is clearly missing. Whether any was added.
  bool add() {
    const BaselineScore baseline = baseline_score(state_);
    SearchStep step = step_from(baseline);
    const Model& model = state_.current.model;
    const std::size_t found = model.effects.size() + model.instrument.size();
    report_(fmt::format("step {}: validation RMS {:.4g} N, chi-squared per degree of freedom {:.2f}", found + 1,
                        step.validation_rms_N,
                        step.validation_chi_squared / (3.0 * static_cast<double>(state_.validation.blocks.size()))));
    step.trials = try_candidates(state_, baseline);
    for (Trial& trial : step.trials) trial.verdict = cheap_gates(state_, baseline, trial);
    std::sort(step.trials.begin(), step.trials.end(),
              [](const Trial& a, const Trial& b) { return a.deviance < b.deviance; });
    const bool room = found < settings_.most_effects;
    // Where one bump was not all that differs over the surface, fields compete with the effects of a few parameters.
    std::vector<Trial> fields;
    if (room && differs_over_surface(model, state_.library()) && clearly_missing())
      fields = try_fields(state_, baseline);
    bool more = field_is_better(fields, step.trials) && keep_field(fields, step);
    while (room && !more) {
      verify_best(baseline, step);
      Trial* const best = preferred(step);
      if (best == nullptr) break;
      more = keep(*best, step);
    }
    if (!more) more = keep_field(fields, step);
    // What is left of an object that differs everywhere is seldom two effects of a few parameters.
    const bool pairs = room && !has_field(model) && clearly_missing() &&
                       state_.budget->allows("effects that noise hides, and pairs of effects");
    if (!more && pairs) more = add_where_noise_hides(baseline, step);
    std::move(fields.begin(), fields.end(), std::back_inserter(step.trials));
    result_.steps.push_back(std::move(step));
    return more;
  }

  // A law of speed by its likelihood, else two effects at once. Whether any was added.
  bool add_where_noise_hides(const BaselineScore& baseline, SearchStep& step) {
    const std::size_t room =
        settings_.most_effects - state_.current.model.effects.size() - state_.current.model.instrument.size();
    std::vector<Trial> more_trials = weigh_by_likelihood(state_, step.trials);
    bool more = false;
    for (Trial& likely : more_trials) {
      if (!more && keep_if_likelier(likely, step)) {
        more = true;
        likely.verdict = {TrialVerdict::Kind::added_apart, "added: more likely with it on the smoothed trajectory"};
      }
    }
    if (!more && room >= 2) {
      report_("  no single effect passes, though something is missing: pairs");
      for (Trial& pair : try_pairs(state_, baseline, step.trials)) {
        if (!more && pair.verdict.passed()) more = keep(pair, step);
        more_trials.push_back(std::move(pair));
      }
    }
    std::move(more_trials.begin(), more_trials.end(), std::back_inserter(step.trials));
    return more;
  }

  // Where no effect with a few parameters passes though something is missing: a property that differs over the surface.
  bool add_field() {
    const Model& model = state_.current.model;
    const bool full = model.effects.size() + model.instrument.size() >= settings_.most_effects;
    if (full || differs_over_surface(model, state_.library()) || !clearly_missing()) return false;
    const BaselineScore baseline = baseline_score(state_);
    SearchStep step = step_from(baseline);
    step.trials = try_fields(state_, baseline);
    const bool more = keep_field(step.trials, step);
    if (!step.trials.empty()) result_.steps.push_back(std::move(step));
    return more;
  }

  bool keep_field(std::vector<Trial>& fields, SearchStep& step) {
    const auto passed = std::find_if(fields.begin(), fields.end(), [](const Trial& t) { return t.verdict.passed(); });
    return passed != fields.end() && keep(*passed, step);
  }

  [[nodiscard]] bool clearly_missing() const {
    if (!state_.budget->allows("more than one effect at once")) return false;
    const Goodness goodness = judge_goodness(data_.train, data_.validation, state_.current.model, data_.window_s);
    return goodness.chi_squared >= goodness.threshold;
  }

  // The expensive gates, of the best trial only; the next one's turn comes when it fails.
  void verify_best(const BaselineScore& baseline, SearchStep& step) const {
    for (Trial& trial : step.trials) {
      if (!trial.verdict.passed()) continue;
      if (!state_.budget->allows("the checks of " + trial.title())) {
        trial.verdict = out_of_time;
        continue;
      }
      trial.verdict = all_gates(state_, baseline, trial);
      const Trial* const mesh = explained_by_mesh(step.trials, trial);
      if (trial.verdict.passed() && mesh != nullptr)
        trial.verdict = mesh->name + " does as much, " + mesh->verdict.words;
      if (trial.verdict.passed()) return;
    }
  }

  // The best of what passed; a special case that does as well is preferred to what contains it, also one that was
  // refused for the noise of the positions: what contains it takes that noise the same way and passed. nullptr: none
  // passed.
  Trial* preferred(SearchStep& step) const {
    const auto best =
        std::find_if(step.trials.begin(), step.trials.end(), [](const Trial& t) { return t.verdict.passed(); });
    if (best == step.trials.end()) return nullptr;
    for (Trial& trial : step.trials) {
      const bool as_good =
          best->validation_gain - trial.validation_gain < settings_.alike_gain * 0.1 * best->validation_gain + 10.0 ||
          trial.validation_rms_N < best->validation_rms_N;
      const bool may_stand = trial.verdict.passed() || trial.verdict.kind == TrialVerdict::Kind::noisy_positions_alone;
      if (may_stand && state_.library().contains(best->name, trial.name) && as_good) {
        best->verdict = "no better than " + trial.name + ", which it contains";
        return &trial;
      }
    }
    return &*best;
  }

  // Adds the trial's effects unless the model, refitted under its own noise, leaves more of the validation data.
  bool keep(Trial& trial, SearchStep& step) {
    return keep_if(trial, step, [&](const SearchState& next) {
      return next.validation_rms_N(next.current.model) < step.validation_rms_N;
    });
  }

  // The same by likelihood: the right one of two models may leave more where noise turns the tip.
  bool keep_if_likelier(Trial& trial, SearchStep& step) {
    const auto deviance = [](const SearchState& state) { return state.validation_deviance(state.current.model); };
    return keep_if(trial, step, [&](const SearchState& next) { return deviance(next) < deviance(state_); });
  }

  bool keep_if(Trial& trial, SearchStep& step, const std::function<bool(const SearchState&)>& better) {
    SearchState next = with_trial(state_, trial);
    if (!better(next)) {
      trial.verdict = "does worse on validation data once all is refitted";
      return false;
    }
    trial.verdict = {TrialVerdict::Kind::added, "added"};
    step.added = trial.title();
    report_(fmt::format("  {}: validation RMS {:.4g} N", step.added, next.validation_rms_N(next.current.model)));
    state_ = std::move(next);
    return true;
  }

  // A law that contains one of the model's and does what that one cannot takes its place. Whether one did.
  bool extend_law() {
    auto laws = weigh_larger_laws(state_);
    if (laws.empty()) return false;
    if (!laws.front().trial.verdict.passed()) {
      for (LargerLaw& law : laws) result_.steps.back().trials.push_back(std::move(law.trial));
      return false;
    }
    LargerLaw& best = laws.front();
    const bool cone = state_.library().traits(best.trial.name).velocity_weakening;
    report_(fmt::format("  {} in place of {}, {}", best.trial.name, best.in_place_of,
                        cone ? "whose cone the forces leave" : "being more likely"));
    state_ = with_trial(state_, best.trial);
    rejected_.insert(best.in_place_of);
    decided_.laws.insert(best.trial.name);
    best.trial.verdict = {TrialVerdict::Kind::added_apart,
                          (cone ? "added: forces leave the cone of " : "added: more likely than ") + best.in_place_of +
                              ", which it contains"};
    SearchStep step = step_from(baseline_score(state_));
    step.added = best.trial.name;
    step.removed = best.in_place_of;
    for (LargerLaw& law : laws) step.trials.push_back(std::move(law.trial));
    result_.steps.push_back(std::move(step));
    return true;
  }

  [[nodiscard]] JointFit fit_without(const std::string& name) const {
    return fit_jointly(state_.train, without_entry(state_.current.model, name),
                       without_coefficients(without_owner(state_.parameters, name)), settings_.iterations, false);
  }

  // The model without the effect, which was fitted so.
  void leave_out(const std::string& name, const JointFit& fit) {
    std::erase_if(result_.found, [&](const FoundEffect& effect) { return effect.name == name; });
    state_.parameters = without_owner(state_.parameters, name);
    state_.current = fit;
    state_.renew_noise(state_.current.model);
    state_.refit();
  }

  // An effect that a later one made needless goes.
  void drop_needless() {
    std::vector<std::string> names;
    for (const auto* entries : {&state_.current.model.effects, &state_.current.model.instrument}) {
      for (const NamedParameters& entry : *entries) names.push_back(entry.name);
    }
    if (names.size() < 2) return;
    for (const std::string& name : names) {
      const JointFit fit = fit_without(name);
      const double here = chi_squared(state_.validation, state_.current.model);
      const double needed = std::max(settings_.minimum_gain, state_.least_share(state_.current.model) * here);
      if (!fit.ok || chi_squared(state_.validation, fit.model) - here > needed) continue;
      report_(fmt::format("  {} is no longer needed", name));
      leave_out(name, fit);
    }
  }

  // What the rival came to when it competed with the effect that was added instead: a start that is near.
  const NamedParameters* warm_start(const std::string& rival, const std::string& added) const {
    const auto adds = [&](const Trial& trial) {
      return trial.verdict.kind == TrialVerdict::Kind::added && (trial.name == added || trial.partner == added);
    };
    for (const SearchStep& step : result_.steps) {
      if (std::none_of(step.trials.begin(), step.trials.end(), adds)) continue;
      for (const Trial& trial : step.trials) {
        if (trial.name == rival) return find_entry(trial.fit.model, rival);
      }
    }
    return nullptr;
  }

  // What stands in the place of a found effect and does better, now that the others are known, takes it. What was put
  // away does not come back, so that this ends.
  bool swap_one() {
    const auto [loser, best, by_likelihood] = best_swap(state_, result_.found, rejected_);
    if (best == nullptr) return false;
    report_(fmt::format("  {} in place of {}{}", best->name, loser->name,
                        by_likelihood ? ", more likely on the smoothed trajectory" : ""));
    SearchStep step = step_from(baseline_score(state_));
    step.added = best->name;
    step.removed = loser->name;
    result_.steps.push_back(std::move(step));
    rejected_.insert(loser->name);
    if (by_likelihood) decided_.places.insert({best->name, loser->name});
    const Model rest = without_entry(state_.current.model, loser->name);
    state_.parameters = joined(without_owner(state_.parameters, loser->name),
                               state_.options(state_.candidate(best->name), rest).parameters);
    state_.current.model = best->model;
    state_.renew_noise(state_.current.model);
    state_.refit();
    return true;
  }

  // What a search counts as noise while something is missing is the same for all blocks of a group, and so takes weight
  // from the best of them: a tip that sticks shows the noise of its tracker, and in equal weight with one that slides
  // it would draw the coefficient of friction down. Values are fitted by the declared noise if that predicts the
  // validation data better, unless the model leaves far more than that noise: then it is not what the error is made of,
  // and its weights would give the blocks of light contact the say and every value an interval that is far too narrow.
  [[nodiscard]] bool declared_noise_predicts_better() const {
    const double left_N = state_.validation_rms_N(state_.current.model);
    if (left_N > settings_.clear_noises * expected_noise_N(data_.validation, state_.current.model)) return false;
    const int iterations = 4 * settings_.iterations;
    const auto compared = state_.compared();
    const auto validated = [&](const FitData& weights) {
      const JointFit fit = fit_jointly(weights, Model(state_.current.model), compared, iterations, false);
      return fit.ok ? chi_squared(state_.declared_validation, fit.model) : std::numeric_limits<double>::infinity();
    };
    return validated(state_.declared_train) < validated(state_.train);
  }

  // What is free in the model that was chosen, fitted to all that may be learnt from. The blocks that it was fitted to.
  FitData fit_values() {
    result_.model = state_.current.model;
    result_.parameters = state_.parameters;
    FitData weights = fit_data(data_.learning, result_.model, data_.window_s);
    if (!declared_noise_predicts_better()) add_misfit(weights, estimate_misfit(weights, result_.model));
    weights.budget = state_.budget.get();
    const bool fields = state_.compared().size() < result_.parameters.size();
    const int iterations = fields ? 2 * settings_.field_iterations : 4 * settings_.iterations;
    result_.fit = fit_jointly(weights, Model(result_.model), result_.parameters, iterations, true);
    if (std::isfinite(result_.fit.chi_squared)) result_.model = result_.fit.model;
    return weights;
  }

  // Where friction falls with speed, its values are read from the forces alone too, and their intervals reach to what
  // was read. Forces that leave the fitted law's own cone show that noise has made the fit prefer a weaker law: then
  // the values are those read and no longer fitted, unless they give back most of what the fit gains at the noisy
  // positions.
  void settle_cone() {
    for (const NamedParameters& entry : state_.current.model.effects) {
      if (!state_.library().traits(entry.name).velocity_weakening) continue;
      if (!state_.budget->allows("friction read from the forces alone")) return;
      const Model others = without_entry(state_.current.model, entry.name);
      const FitData blocks = fit_data(data_.learning, state_.current.model, data_.window_s);
      const auto samples = cone_samples(cone_evidence(blocks, *data_.learning.noise, others, data_.force_floor_N),
                                        data_.learning.recording->f_W_N);
      const auto cone = cone_of(samples);
      const auto read = read_falling(samples);
      if (!cone || !read) return;
      for (std::size_t draw = 0; draw < NoiseModel::null_simulations; ++draw) {
        if (!state_.budget->allows("friction read from the forces alone")) return;
        Model as_read = state_.current.model;
        if (const auto again = read_again(samples, draw)) set_falling(as_read, entry.name, *again);
        result_.readings.push_back({draw, std::move(as_read)});
      }
      if (cone->widest > settings_.within_cone * entry.parameters.at("mu_static"))
        fix_friction_values(entry.name, *read);
      return;
    }
  }

  // `name` is its own: the entry that it came from goes with the state.
  void fix_friction_values(std::string name, const FallingCoefficient& read) {
    SearchState held = state_;
    set_falling(held.current.model, name, read);
    std::erase_if(held.parameters, [&](const FreeParameter& p) { return p.owner == name && is_of_falling(p.name); });
    held.renew_noise(held.current.model);
    held.refit();
    const auto square = [&](const Model& model) { return std::pow(state_.validation_rms_N(model), 2); };
    const double fitted = square(state_.current.model);
    if (!(square(held.current.model) - fitted < settings_.read_share * (square(result_.base) - fitted))) return;
    report_(fmt::format("  {}: its values are read from the forces, which leave the cone of the fitted law", name));
    state_ = std::move(held);
    read_ = [this, name = std::move(name)](Model& model, std::size_t world) {
      for (const NullFit& reading : result_.readings) {
        if (reading.world == world) find_entry(model, name)->parameters = find_entry(reading.model, name)->parameters;
      }
    };
  }

  // All that may be learnt from, with the misfit that the model leaves there.
  [[nodiscard]] FitData learning_blocks(const Model& model) const {
    FitData blocks = fit_data(data_.learning, model, data_.window_s);
    add_misfit(blocks, estimate_misfit(blocks, model));
    return blocks;
  }

  // An effect none of whose sizes is determined is not found, unless the rest cannot do without it: a bump beside a
  // straight scan may be a small one on the line or a large one off it, but it is there.
  void drop_unidentifiable() {
    const FitData blocks = learning_blocks(state_.current.model);
    const auto undetermined =
        find_undetermined(blocks, *data_.learning.recording, state_.current.model, state_.parameters, state_.library());
    for (const std::string& name : without_size(undetermined, state_.parameters)) {
      const JointFit fit = fit_without(name);
      const double here = chi_squared(state_.validation, state_.current.model);
      if (!fit.ok || chi_squared(state_.validation, fit.model) - here > settings_.minimum_gain) continue;
      report_(fmt::format("  {}: this recording does not determine its size", name));
      result_.dropped.push_back(name);
      leave_out(name, fit);
    }
  }

  // On the values that are written.
  void judge_values() {
    result_.undetermined = find_undetermined(learning_blocks(result_.model), *data_.learning.recording, result_.model,
                                             result_.parameters, state_.library());
    result_.questions =
        question_values(*data_.learning.recording, data_.learning.predictor->predict(result_.model), result_.model,
                        result_.parameters, result_.fit, data_.position_noise_m, state_.library());
  }

  // Values, and what noise and an error of the mesh make of them.
  void settle_values() {
    const FitData weights = fit_values();
    judge_values();
    // Coefficients of fields are held in simulated recordings; their part of the uncertainty is in the fit's
    // covariance.
    result_.draws = bootstrap_fits(data_.learning, weights, result_.fit, without_coefficients(result_.parameters),
                                   settings_.iterations / 2, read_);
    result_.noisier = noisier_fits(data_.learning, weights, result_.fit, without_coefficients(result_.parameters),
                                   settings_.iterations / 2);
    result_.intervals_cut_short =
        result_.draws.size() < fewest_draws && !state_.budget->allows("simulated recordings for the intervals");
  }

  // A bump or a wave that by the interval to be written may be the mesh's declared error is not found. The gate of its
  // trial saw the training blocks alone, and values that others have changed since. Whether one went.
  bool drop_what_may_be_mesh() {
    const auto weak = std::find_if(result_.found.begin(), result_.found.end(), [&](const FoundEffect& effect) {
      return !displaces_for_sure(state_, result_.fit, result_.parameters, result_.draws, effect.name);
    });
    if (weak == result_.found.end()) return false;
    const std::string name = weak->name;
    const JointFit fit = fit_without(name);
    if (!fit.ok) return false;
    report_(fmt::format("  {}: {}", name, maybe_within_mesh().words));
    result_.within_mesh_tolerance.push_back(name);
    leave_out(name, fit);
    return true;
  }

  // Names, then values and intervals, then, for the first time, the held-out data; then, where those or the validation
  // blocks show that something is missing, a law for it, from what may be learnt alone.
  void finish() {
    result_.time_limit_s = state_.budget->limit_s();
    drop_unidentifiable();
    std::erase_if(result_.found,
                  [&](const FoundEffect& effect) { return find_entry(result_.start, effect.name) != nullptr; });
    settle_waves(state_.current.model, state_.library());
    settle_cone();
    state_.budget->turn_to_values();
    do {
      settle_values();
    } while (drop_what_may_be_mesh());
    // A heavy tool, which only the search's model knows, hides the load from the start's. What that model explains in
    // the file's own order needs no other.
    if (!result_.data_fault) result_.data_fault = order_fault(result_.model);
    if (!result_.data_fault) {
      const DetectorSide train{data_.train.recording, &state_.declared_train, data_.train.noise};
      const DetectorSide validation{data_.validation.recording, &state_.declared_validation, data_.validation.noise};
      result_.data_fault = find_coefficient_fault(train, validation, result_.base, result_.model, *state_.candidates);
    }
    judge_on_holdout(data_, settings_.iterations, *state_.budget, result_);
    if (result_.data_fault) {
      result_.model = result_.base;  // nothing is learnt from data that are wrong
      result_.found.clear();
      result_.undetermined.clear();
      result_.questions.clear();
    } else if (result_.calls_for_law() || calls_for_law(state_)) {
      result_.law = search_law(state_, result_.base, report_);
      judge_law_on_holdout(data_, result_);
    }
    result_.not_tried = state_.budget->not_tried();
  }

  [[nodiscard]] std::optional<std::string> order_fault(const Model& model) const {
    const FitData blocks = fit_data(data_.learning, model, data_.window_s);
    return find_order_fault({data_.learning.recording, &blocks, data_.learning.noise}, model);
  }

  const SearchData& data_;
  const SearchSettings& settings_;
  const Report& report_;
  SearchState state_;
  std::set<std::string> rejected_;
  DecidedPairs decided_;
  ReadValues read_;
  SearchResult result_;
};

}  // namespace

SearchResult search_effects(const SearchData& data, const Model& start,
                            const std::vector<rendering::Candidate>& candidates, const SearchSettings& settings,
                            const Report& report) {
  return Search(data, candidates, settings, start, report).run();
}

}  // namespace touchstone::discrepancy
