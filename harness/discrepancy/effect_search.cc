#include "harness/discrepancy/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone {
namespace {

// The two recordings under the noise that the current model implies.
struct Judged {
  FitData train;
  FitData holdout;
};

FitData fit_data(const Recording& recording, Predictor& predictor, NoiseModel& noise, const Model& model,
                 double window_s) {
  FitData data;
  data.predictor = &predictor;
  data.blocks = make_blocks(recording.motion, window_s);
  data.measured_N = block_means(data.blocks, recording.f_W_N);
  data.noise = noise.of(model, predictor.predict(model), data.blocks);
  return data;
}

Judged judge(const SearchData& data, const Model& model) {
  return {fit_data(*data.train, *data.train_predictor, *data.train_noise, model, data.window_s),
          fit_data(*data.holdout, *data.holdout_predictor, *data.holdout_noise, model, data.window_s)};
}

FreeParameter base_stiffness(const Model& start) {
  const auto given = start.parameters.find("stiffness_N_per_m");
  if (given == start.parameters.end()) {
    throw BadData(fmt::format(
        "{}: /parameters: stiffness_N_per_m is needed: the finder fits it together with every effect", start.source));
  }
  return log_base_parameter("stiffness_N_per_m", 0.1 * given->second, 10.0 * given->second);
}

Model with_entry(const Model& model, Side side, const NamedParameters& entry) {
  Model extended = model;
  (side == Side::contact ? extended.effects : extended.instrument).push_back(entry);
  return extended;
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

}  // namespace

double rms_force_error_N(const Recording& recording, const Prediction& prediction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < recording.size(); ++i) sum += (recording.f_W_N[i] - prediction.f_W_N[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(recording.size()));
}

SearchResult search_effects(const SearchData& data, const Model& start, const std::vector<Candidate>& candidates,
                            const SearchSettings& settings, const Report& report) {
  SearchResult result;
  result.base_holdout_rms_N = rms_force_error_N(*data.holdout, data.holdout_predictor->predict(start));
  result.train_rms_before_N = rms_force_error_N(*data.train, data.train_predictor->predict(start));
  std::vector<FreeParameter> parameters{base_stiffness(start)};

  Judged judged = judge(data, start);
  JointFit current = fit_jointly(judged.train, start, parameters, settings.iterations, false);
  result.base = current.model;

  while (true) {
    // The noise follows the model: friction adds its own, damping too.
    judged = judge(data, current.model);
    current = fit_jointly(judged.train, Model(current.model), parameters, settings.iterations, false);
    const double train_chi = chi_squared(judged.train, current.model);
    const double holdout_chi = chi_squared(judged.holdout, current.model);
    const double rms = rms_force_error_N(*data.holdout, data.holdout_predictor->predict(current.model));
    const std::size_t found = current.model.effects.size() + current.model.instrument.size();
    report(fmt::format("step {}: held-out RMS {:.4f} N, chi2/dof train {:.3f} holdout {:.3f}", found, rms,
                       train_chi / (3.0 * static_cast<double>(judged.train.blocks.size())),
                       holdout_chi / (3.0 * static_cast<double>(judged.holdout.blocks.size()))));
    if (found >= settings.most_effects) break;

    const Prediction now = data.train_predictor->predict(current.model);
    const RecordingScales scales =
        measure_scales(*data.train, now, data.force_floor_N, current.model.parameters.at("stiffness_N_per_m"));
    SearchStep step;
    for (const Candidate& candidate : candidates) {
      if (find_entry(current.model, candidate.name) != nullptr) continue;
      const CandidateFit options = candidate_fit(candidate, scales, *data.train, now);
      Trial trial;
      trial.name = candidate.name;
      trial.side = candidate.side;
      trial.fit = best_fit(judged.train, current.model, options, parameters, settings.iterations);
      if (!trial.fit.ok) continue;
      trial.train_gain = train_chi - trial.fit.chi_squared;
      trial.holdout_gain = holdout_chi - chi_squared(judged.holdout, trial.fit.model);
      trial.holdout_rms_N = rms_force_error_N(*data.holdout, data.holdout_predictor->predict(trial.fit.model));
      step.trials.push_back(std::move(trial));
    }
    std::sort(step.trials.begin(), step.trials.end(),
              [](const Trial& a, const Trial& b) { return a.holdout_gain > b.holdout_gain; });
    for (Trial& trial : step.trials) {
      std::string values;
      for (std::size_t i = parameters.size();
           i < parameters.size() + 5 && i < static_cast<std::size_t>(trial.fit.u.size()); ++i) {
        values += fmt::format(" {:.4g}", trial.fit.u[static_cast<Eigen::Index>(i)]);
      }
      report(fmt::format("   {:22s} train {:9.1f} holdout {:9.1f} rms {:.4f}  u:{}", trial.name, trial.train_gain,
                         trial.holdout_gain, trial.holdout_rms_N, values));
    }
    const auto strong = [&](const Trial& trial) {
      const double share = 1.0 - trial.holdout_rms_N * trial.holdout_rms_N / (rms * rms);
      return trial.holdout_gain > settings.minimum_gain && trial.train_gain > settings.minimum_gain &&
             share > settings.minimum_share;
    };
    const auto best = std::find_if(step.trials.begin(), step.trials.end(), strong);
    if (best == step.trials.end()) {
      result.steps.push_back(std::move(step));
      break;
    }
    step.added = best->name;
    report(fmt::format("  added {}", best->name));
    const auto candidate =
        std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) { return c.name == best->name; });
    const CandidateFit options = candidate_fit(*candidate, scales, *data.train, now);
    parameters.insert(parameters.end(), options.parameters.begin(), options.parameters.end());
    current = best->fit;
    result.steps.push_back(std::move(step));
  }
  result.model = current.model;
  result.parameters = parameters;
  result.fit = fit_jointly(judged.train, Model(current.model), parameters, settings.iterations, true);
  result.train_rms_after_N = rms_force_error_N(*data.train, data.train_predictor->predict(result.model));
  result.holdout_rms_after_N = rms_force_error_N(*data.holdout, data.holdout_predictor->predict(result.model));
  result.goodness =
      chi_squared(judged.holdout, result.model) / (3.0 * static_cast<double>(judged.holdout.blocks.size()));
  return result;
}

}  // namespace touchstone
