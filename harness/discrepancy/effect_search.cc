#include "harness/discrepancy/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "harness/base/error.h"
#include "harness/discrepancy/data_faults.h"
#include "harness/discrepancy/regimes.h"

namespace touchstone {
namespace {

// An effect that another contains as a special case: alike, the smaller is the finding, not a riddle.
const std::vector<std::pair<std::string, std::string>> contained_in{
    {"coulomb-friction", "stribeck-friction"},
    {"coulomb-friction", "anisotropic-friction"},
};

bool contains(const std::string& larger, const std::string& smaller) {
  return std::find(contained_in.begin(), contained_in.end(), std::pair(smaller, larger)) != contained_in.end();
}

FitData fit_data(const Evidence& evidence, const Model& model, double window_s) {
  FitData data;
  data.predictor = evidence.predictor;
  const auto& t_s = evidence.recording->motion.t_s;
  for (const SampleBlock& block : make_blocks(evidence.recording->motion, window_s)) {
    if (evidence.part.contains(t_s[block.begin], t_s.front())) data.blocks.push_back(block);
  }
  data.measured_N = block_means(data.blocks, evidence.recording->f_W_N);
  data.noise = evidence.noise->of(model, evidence.predictor->predict(model), data.blocks);
  return data;
}

FreeParameter base_stiffness(const Model& start) {
  const auto given = start.parameters.find("stiffness_N_per_m");
  if (given == start.parameters.end()) {
    throw BadData(fmt::format("{}: /parameters: stiffness_N_per_m is needed: it is fitted together with every effect",
                              start.source));
  }
  return log_base_parameter("stiffness_N_per_m", 0.1 * given->second, 10.0 * given->second);
}

Model with_entry(const Model& model, Side side, const NamedParameters& entry) {
  Model extended = model;
  (side == Side::contact ? extended.effects : extended.instrument).push_back(entry);
  return extended;
}

Model without_entry(const Model& model, const std::string& name) {
  Model reduced = model;
  for (auto* entries : {&reduced.effects, &reduced.instrument}) {
    std::erase_if(*entries, [&](const NamedParameters& entry) { return entry.name == name; });
  }
  return reduced;
}

std::vector<FreeParameter> without_owner(const std::vector<FreeParameter>& parameters, const std::string& name) {
  std::vector<FreeParameter> kept = parameters;
  std::erase_if(kept, [&](const FreeParameter& parameter) { return parameter.owner == name; });
  return kept;
}

// The best fit over the candidate's starts: a few steps from each, the best one finished.
JointFit best_fit(const FitData& data, const Model& current, const CandidateFit& candidate,
                  std::vector<FreeParameter> parameters, int iterations) {
  parameters.insert(parameters.end(), candidate.parameters.begin(), candidate.parameters.end());
  JointFit best;
  const bool several = candidate.starts.size() > 1;
  for (const NamedParameters& entry : candidate.starts) {
    const Model start = with_entry(current, candidate.side, entry);
    JointFit fit = fit_jointly(data, start, parameters, several ? iterations / 3 : iterations, false);
    if (fit.ok && (!best.ok || fit.chi_squared < best.chi_squared)) best = std::move(fit);
  }
  if (best.ok && several) {
    JointFit finished = fit_jointly(data, Model(best.model), parameters, iterations, false);
    if (finished.ok && finished.chi_squared < best.chi_squared) best = std::move(finished);
  }
  return best;
}

// Sum and standard error of the difference of two models' chi-squared over the blocks. Neighbouring blocks share what
// the model lacks, so that runs of them are summed before their spread is taken.
std::pair<double, double> paired_difference(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr std::size_t run = 8;
  std::vector<double> sums;
  for (std::size_t i = 0; i < a.size(); i += run) {
    double sum = 0.0;
    for (std::size_t j = i; j < std::min(i + run, a.size()); ++j) sum += a[j] - b[j];
    sums.push_back(sum);
  }
  double total = 0.0;
  for (const double sum : sums) total += sum;
  const double mean = total / static_cast<double>(sums.size());
  double squares = 0.0;
  for (const double sum : sums) squares += (sum - mean) * (sum - mean);
  return {total, std::sqrt(squares)};
}

class Search {
 public:
  Search(const SearchData& data, const std::vector<Candidate>& candidates, const SearchSettings& settings,
         const Report& report)
      : data_(data), candidates_(candidates), settings_(settings), report_(report) {}

  SearchResult run(const Model& start) {
    result_.start = start;
    parameters_ = {base_stiffness(start)};
    renew_noise(start);
    current_ = fit_jointly(train_, start, parameters_, settings_.iterations, false);
    if (!current_.ok) current_.model = start;
    renew_noise(current_.model);
    refit();
    result_.base = current_.model;
    while (add_one()) {
    }
    drop_needless();
    weigh_rivals();
    finish();
    return std::move(result_);
  }

 private:
  // Noise follows the model: friction adds its own, damping too.
  void renew_noise(const Model& model) {
    train_ = fit_data(data_.train, model, data_.window_s);
    holdout_ = fit_data(data_.holdout, model, data_.window_s);
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
    const RecordingScales scales = measure_scales(recording, now, data_.force_floor_N,
                                                  model.parameters.at("stiffness_N_per_m"), data_.position_noise_m);
    return candidate_fit(candidate, scales, recording, now);
  }

  // What the candidate gains on held-out data of worlds where the current model is the truth: noise and the mesh's
  // declared error alone. Returned is a bar well above (parametric bootstrap, Efron and Tibshirani 1993, chapter 6.5;
  // few worlds, so mean and spread rather than a quantile).
  double null_bar(const Candidate& candidate) const {
    const Prediction train_nominal = data_.train.predictor->predict(current_.model);
    const Prediction holdout_nominal = data_.holdout.predictor->predict(current_.model);
    std::vector<double> gains;
    for (std::size_t world = 0; world < NoiseModel::null_worlds; ++world) {
      Recording recording = *data_.train.recording;
      recording.f_W_N = data_.train.noise->null_forces(current_.model, train_nominal, world);
      FitData train = train_;
      train.measured_N = block_means(train.blocks, recording.f_W_N);
      FitData holdout = holdout_;
      holdout.measured_N =
          block_means(holdout.blocks, data_.holdout.noise->null_forces(current_.model, holdout_nominal, world));
      const JointFit base = fit_jointly(train, Model(current_.model), parameters_, settings_.iterations, false);
      if (!base.ok) continue;
      const JointFit with =
          best_fit(train, base.model, options(candidate, base.model, recording), parameters_, settings_.iterations);
      if (with.ok) gains.push_back(chi_squared(holdout, base.model) - chi_squared(holdout, with.model));
    }
    if (gains.size() < 2) return settings_.minimum_gain;
    double mean = 0.0;
    for (const double gain : gains) mean += gain / static_cast<double>(gains.size());
    double squares = 0.0;
    for (const double gain : gains) squares += (gain - mean) * (gain - mean);
    return std::max(
        settings_.minimum_gain,
        std::max(0.0, mean) + settings_.null_deviations * std::sqrt(squares / static_cast<double>(gains.size() - 1)));
  }

  // The regime of held-out data that the trial makes worse than noise can, by a share of what it gains in all; empty:
  // none. (A short regime whose error is all noise, such as the first contact, may go up by chance.)
  std::string worsened(const Prediction& before, const Model& trial) const {
    const Prediction after = data_.holdout.predictor->predict(trial);
    const auto regimes = sort_by_regime(data_.holdout, before, after, data_.force_floor_N);
    const auto grown = [](const Regime& regime) {
      return static_cast<double>(regime.samples) *
             (regime.after_N * regime.after_N - regime.before_N * regime.before_N);
    };
    double gained = 0.0;
    for (const Regime& regime : regimes) gained -= regime.kind == "phase" ? std::min(0.0, grown(regime)) : 0.0;
    for (const Regime& regime : regimes) {
      if (regime.kind != "phase") continue;
      const bool clear = regime.after_N > regime.before_N + regime.error95_N;
      if (clear && grown(regime) > settings_.worsening * gained) return regime.name;
    }
    return "";
  }

  bool add_one() {
    SearchStep step;
    step.train_chi_squared = chi_squared(train_, current_.model);
    step.holdout_chi_squared = chi_squared(holdout_, current_.model);
    step.holdout_rms_N = holdout_rms(current_.model);
    const std::size_t found = current_.model.effects.size() + current_.model.instrument.size();
    report_(fmt::format("step {}: held-out RMS {:.4f} N, chi-squared per degree of freedom {:.2f}", found + 1,
                        step.holdout_rms_N,
                        step.holdout_chi_squared / (3.0 * static_cast<double>(holdout_.blocks.size()))));
    std::vector<CandidateFit> fits;
    for (const Candidate& candidate : candidates_) {
      if (find_entry(current_.model, candidate.name) != nullptr) continue;
      Trial trial;
      trial.name = candidate.name;
      trial.side = candidate.side;
      trial.fit =
          best_fit(train_, current_.model, options(candidate, current_.model), parameters_, settings_.iterations);
      if (!trial.fit.ok) continue;
      trial.train_gain = step.train_chi_squared - trial.fit.chi_squared;
      trial.holdout_gain = step.holdout_chi_squared - chi_squared(holdout_, trial.fit.model);
      trial.holdout_rms_N = holdout_rms(trial.fit.model);
      trial.verdict = weakness(trial, step);
      step.trials.push_back(std::move(trial));
    }
    std::sort(step.trials.begin(), step.trials.end(),
              [](const Trial& a, const Trial& b) { return a.holdout_gain > b.holdout_gain; });
    if (found < settings_.most_effects) verify_best(step);
    auto best = std::find_if(step.trials.begin(), step.trials.end(), [](const Trial& t) { return t.verdict.empty(); });
    const bool more = best != step.trials.end() && found < settings_.most_effects;
    if (more) {
      // A special case that does as well is preferred to what contains it.
      for (auto& trial : step.trials) {
        if (trial.verdict.empty() && contains(best->name, trial.name) &&
            best->holdout_gain - trial.holdout_gain < settings_.alike_gain * 0.1 * best->holdout_gain + 10.0) {
          best->verdict = "no better than " + trial.name + ", which it contains";
          best = std::find_if(step.trials.begin(), step.trials.end(),
                              [&](const Trial& t) { return t.name == trial.name; });
          break;
        }
      }
      best->verdict = "added";
      step.added = best->name;
      report_(fmt::format("  {}: held-out RMS {:.4f} N", best->name, best->holdout_rms_N));
      const CandidateFit chosen = options(candidate(best->name), current_.model);
      parameters_.insert(parameters_.end(), chosen.parameters.begin(), chosen.parameters.end());
      current_ = best->fit;
      renew_noise(current_.model);
      refit();
    }
    result_.steps.push_back(std::move(step));
    return more;
  }

  // The dear checks, of the best trial only; the next one's turn comes when it fails.
  void verify_best(SearchStep& step) const {
    const Prediction before = data_.holdout.predictor->predict(current_.model);
    for (Trial& trial : step.trials) {
      if (!trial.verdict.empty()) continue;
      const std::string worse = worsened(before, trial.fit.model);
      if (!worse.empty()) {
        trial.verdict = fmt::format("makes {} worse", worse);
        continue;
      }
      trial.null_bar = null_bar(candidate(trial.name));
      if (trial.holdout_gain > trial.null_bar) return;
      trial.verdict = "no more than noise and the mesh's declared error give where nothing is missing";
    }
  }

  // Empty: strong enough to be added.
  std::string weakness(const Trial& trial, const SearchStep& step) const {
    const double share = 1.0 - trial.holdout_rms_N * trial.holdout_rms_N / (step.holdout_rms_N * step.holdout_rms_N);
    if (trial.train_gain < settings_.minimum_gain) return "no more than noise on the training blocks";
    if (trial.holdout_gain < settings_.minimum_gain) return "no more than noise on the held-out blocks";
    if (trial.holdout_gain < settings_.minimum_share * step.holdout_chi_squared || share < settings_.minimum_share) {
      return "too small to matter";
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
    std::vector<std::pair<std::string, Side>> names;
    for (const NamedParameters& entry : current_.model.effects) names.emplace_back(entry.name, Side::contact);
    for (const NamedParameters& entry : current_.model.instrument) names.emplace_back(entry.name, Side::instrument);
    const auto here = block_chi_squared(holdout_, current_.model);
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
        if (find_entry(current_.model, other.name) != nullptr) continue;
        const JointFit fit = best_fit(train_, bare.model, options(other, bare.model), kept, settings_.iterations);
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
        rival.alike = close && lost < settings_.alike_gain * found.holdout_gain && !contains(other.name, name) &&
                      !contains(name, other.name);
        found.rivals.push_back(std::move(rival));
      }
      std::sort(found.rivals.begin(), found.rivals.end(),
                [](const Rival& a, const Rival& b) { return a.holdout_gain_lost < b.holdout_gain_lost; });
      result_.found.push_back(std::move(found));
    }
  }

  void finish() {
    settle_texture(current_.model);
    result_.model = current_.model;
    result_.parameters = parameters_;
    result_.fit = fit_jointly(train_, Model(current_.model), parameters_, settings_.iterations, true);
    if (std::isfinite(result_.fit.chi_squared)) result_.model = result_.fit.model;
    result_.goodness = chi_squared(holdout_, result_.model) /
                       (3.0 * static_cast<double>(std::max<std::size_t>(1, holdout_.blocks.size())));
    const Prediction nominal = data_.holdout.predictor->predict(result_.model);
    for (std::size_t world = 0; world < NoiseModel::null_worlds; ++world) {
      FitData null = holdout_;
      null.measured_N = block_means(null.blocks, data_.holdout.noise->null_forces(result_.model, nominal, world));
      result_.null_goodness = std::max(
          result_.null_goodness,
          chi_squared(null, result_.model) / (3.0 * static_cast<double>(std::max<std::size_t>(1, null.blocks.size()))));
    }
    const DetectorSide train{data_.train.recording, &train_, data_.train.noise};
    const DetectorSide holdout{data_.holdout.recording, &holdout_, data_.holdout.noise};
    result_.structure = detect_structure(train, holdout, result_.model);
    result_.data_fault = find_data_fault(train, holdout, result_.base, result_.model);
    const auto squares = data_.holdout.noise->expected_squares(result_.model, nominal);
    const auto& t_s = data_.holdout.recording->motion.t_s;
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if (!data_.holdout.part.contains(t_s[i], t_s.front())) continue;
      sum += squares[i];
      count += 1.0;
    }
    result_.noise_rms_N = std::sqrt(sum / std::max(1.0, count));
    if (result_.data_fault) {
      // Nothing is learnt from data that are wrong.
      result_.model = result_.base;
      result_.found.clear();
    }
  }

  // The same wave has many names: its direction is taken in [0, pi), its phase in [0, 2 pi).
  static void settle_texture(Model& model) {
    NamedParameters* const texture = find_entry(model, "surface-texture");
    if (texture == nullptr) return;
    constexpr double pi = std::numbers::pi;
    double& direction = texture->parameters.at("direction_rad");
    double& phase = texture->parameters.at("phase_rad");
    direction -= 2.0 * pi * std::floor(direction / (2.0 * pi));
    if (direction >= pi) {
      direction -= pi;
      phase = pi - phase;
    }
    phase -= 2.0 * pi * std::floor(phase / (2.0 * pi));
  }

  const SearchData& data_;
  const std::vector<Candidate>& candidates_;
  const SearchSettings& settings_;
  const Report& report_;
  std::vector<FreeParameter> parameters_;
  FitData train_;
  FitData holdout_;
  JointFit current_;
  SearchResult result_;
};

}  // namespace

double rms_force_error_N(const Evidence& evidence, const Prediction& prediction) {
  const Recording& recording = *evidence.recording;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (!evidence.part.contains(recording.motion.t_s[i], recording.motion.t_s.front())) continue;
    sum += (recording.f_W_N[i] - prediction.f_W_N[i]).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, count)));
}

SearchResult search_effects(const SearchData& data, const Model& start, const std::vector<Candidate>& candidates,
                            const SearchSettings& settings, const Report& report) {
  return Search(data, candidates, settings, report).run(start);
}

}  // namespace touchstone
