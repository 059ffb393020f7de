#include "harness/pipeline/fitting/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/fitting/minimise.h"
#include "harness/pipeline/fitting/objective.h"
#include "harness/pipeline/fitting/uncertainty.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/predictor.h"
#include "harness/report/quantity.h"
#include "harness/surface/mesh_warnings.h"

namespace touchstone::pipeline {
using recording::InTrajectoryMode;
using recording::Recording;
using rendering::Model;

namespace {

constexpr std::size_t profile_points = 41;
constexpr double flat = 0.01;  // a metric that changes by less, relatively, over the whole search range says nothing

// Where the model's values lie on the unit scale; on a bound they are moved in, so that a search can start there.
std::vector<double> start_of(const std::vector<Estimate>& estimates) {
  std::vector<double> out;
  out.reserve(estimates.size());
  for (const Estimate& one : estimates)
    out.push_back(std::clamp(one.parameter.to_unit(one.parameter.initial), 0.01, 0.99));
  return out;
}

class Problem {
 public:
  Problem(const Objective& objective, Model model, std::vector<FitParameter> parameters, std::vector<std::size_t> part)
      : objective_(objective), model_(std::move(model)), parameters_(std::move(parameters)), part_(std::move(part)) {}

  [[nodiscard]] Model model_at(const std::vector<double>& u) const {
    std::vector<double> values;
    values.reserve(parameters_.size());
    for (std::size_t i = 0; i < parameters_.size(); ++i) values.push_back(parameters_[i].from_unit(u[i]));
    return with_values(model_, parameters_, values);
  }
  [[nodiscard]] double metric_at(const std::vector<double>& u) const {
    ++evaluations_;
    return objective_.value(model_at(u), part_);
  }
  [[nodiscard]] std::vector<double> losses_at(const std::vector<double>& u) const {
    return objective_.losses(model_at(u), part_);
  }
  [[nodiscard]] const std::vector<std::size_t>& part() const { return part_; }
  [[nodiscard]] std::size_t evaluations() const { return evaluations_; }

 private:
  const Objective& objective_;
  Model model_;
  std::vector<FitParameter> parameters_;
  std::vector<std::size_t> part_;
  mutable std::size_t evaluations_ = 0;
};

// The metric over one parameter; the others follow, each place starting from its neighbour's answer.
void profile(const Problem& problem, const std::vector<double>& best, std::size_t which, Estimate& out) {
  std::map<double, double> points;
  const auto walk = [&](double from, double to, std::size_t steps) {
    std::vector<double> u = best;
    for (std::size_t i = 0; i <= steps; ++i) {
      u[which] = from + (to - from) * static_cast<double>(i) / static_cast<double>(steps);
      if (best.size() == 1) {
        points[u[which]] = problem.metric_at(u);
        continue;
      }
      std::vector<double> others;
      for (std::size_t k = 0; k < u.size(); ++k) {
        if (k != which) others.push_back(u[k]);
      }
      const auto spread = [&](const std::vector<double>& v) {
        std::vector<double> all = u;
        for (std::size_t k = 0, j = 0; k < all.size(); ++k) {
          if (k != which) all[k] = v[j++];
        }
        return all;
      };
      const Minimum found =
          minimise_near([&](const std::vector<double>& v) { return problem.metric_at(spread(v)); }, others, 0.02);
      u = spread(found.u);
      points[u[which]] = found.value;
    }
  };
  const auto left = static_cast<std::size_t>(std::lround(best[which] * static_cast<double>(profile_points)));
  walk(best[which], 0.0, std::max<std::size_t>(left, 1));
  walk(best[which], 1.0, std::max<std::size_t>(profile_points - std::min(left, profile_points), 1));
  for (const auto& [u, metric] : points) {
    out.profile_value.push_back(out.parameter.from_unit(u));
    out.profile_metric.push_back(metric);
  }
}

void warn(const std::vector<double>& best, FitResult& result) {
  for (std::size_t i = 0; i < best.size(); ++i) {
    const Estimate& one = result.estimates[i];
    const std::string& name = one.parameter.name;
    if (best[i] < 1e-3 || best[i] > 1.0 - 1e-3) {
      result.warnings.push_back(
          fmt::format("{}: the minimum lies on the bound {} of the search; give wider bounds, {}=low:high", name,
                      report::display_setting(one.value, one.parameter.unit), name));
    }
    const auto [low, high] = std::ranges::minmax(one.profile_metric);
    if (!(high - low > flat * high)) {
      result.warnings.push_back(
          fmt::format("{}: the metric changes by less than {} % from {} to {}: this recording does not determine it",
                      name, 100.0 * flat, one.parameter.low, one.parameter.high));
    }
    const double span = one.parameter.to_unit(one.high95) - one.parameter.to_unit(one.low95);
    if (one.interval_known && span > 0.5) {
      result.warnings.push_back(fmt::format(
          "{}: the 95 % interval covers more than half of the search range: this recording hardly determines it",
          name));
    }
  }
}

std::vector<std::pair<double, double>> bands(const Recording& recording, const std::vector<std::size_t>& part) {
  std::vector<std::pair<double, double>> out;
  const std::vector<double>& t_s = recording.motion.t_s;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (i == 0 || part[i] != part[i - 1] + 1) out.emplace_back(t_s[part[i]], t_s[part[i]]);
    out.back().second = t_s[part[i]];
  }
  // A plot shows so many; ranges that fine are drawn as none.
  if (out.size() > 500) out.clear();
  return out;
}

std::vector<metrics::Series> signals(const Recording& recording, const std::vector<Vec3>& rendered) {
  std::vector<metrics::Series> out;
  for (const char* const which : {"measured", "rendered"}) {
    const std::vector<Vec3>& forces = which[0] == 'm' ? recording.f_W_N : rendered;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      metrics::SeriesRecorder recorder(fmt::format("{}_{}", which, "xyz"[axis]), "N");
      for (std::size_t i = 0; i < forces.size(); ++i) recorder.add(recording.motion.t_s[i], forces[i][axis]);
      out.push_back(recorder.series());
    }
  }
  return out;
}

Recording load(const EvaluationRequest& request) {
  recording::Loaded<Recording> loaded = load_recording(request.recording, request.clock);
  if (request.flip_force) {
    for (Vec3& f : loaded.value.f_W_N) f = -f;
  }
  return std::move(loaded.value);
}

MotionColumns in_motion(const FitRequest& request, const EvaluationInputs& inputs, const Recording& recording) {
  if (request.evaluation.in_trajectory == InTrajectoryMode::measured) return recording.motion;
  const recording::OutTrajectory out = rendering::make_out_trajectory(
      recording, *inputs.surface, {inputs.tip_radius_m, request.evaluation.contact_threshold_N});
  if (request.evaluation.in_trajectory == InTrajectoryMode::whole_force)
    return rendering::whole_force_in_trajectory(out, recording.f_W_N, inputs.stiffness_N_per_m).motion;
  return rendering::synthesize_in_trajectory(out, inputs.stiffness_N_per_m).motion;
}

}  // namespace

FitResult run_fit(const rendering::Catalogue& catalogue, const FitRequest& request) {
  FitResult result;
  result.metric = request.metric;
  check_fit_metric(request.metric);
  const EvaluationInputs inputs = load_inputs(catalogue, request.evaluation);
  result.warnings = mesh_warnings(*inputs.surface);
  std::ranges::copy_if(inputs.messages, std::back_inserter(result.notes), [&](const std::string& said) {
    return std::ranges::find(result.warnings, said) == result.warnings.end();
  });
  std::vector<FitParameter> parameters;
  for (const std::string& text : request.parameters) {
    parameters.push_back(parse_fit_parameter(catalogue, text, inputs.model));
    if (parameters.back().key == "stiffness_N_per_m" &&
        request.evaluation.in_trajectory != InTrajectoryMode::measured && !request.evaluation.stiffness_N_per_m) {
      throw UsageError(
          "a synthesized in-trajectory is made with the stiffness, so every stiffness fits it; give --in-trajectory "
          "measured "
          "(the real positions, for compliant objects), or --stiffness for an in-trajectory that stays");
    }
    result.estimates.emplace_back();
    result.estimates.back().parameter = parameters.back();
  }
  if (parameters.empty()) throw UsageError("--parameter: name at least one parameter to fit");

  const Recording recording = load(request.evaluation);
  const auto predictor = catalogue.make_predictor(inputs.surface, in_motion(request, inputs, recording));
  metrics::MetricOptions options;
  options.force_floor_N = request.evaluation.contact_threshold_N;
  if (request.evaluation.force_threshold_N) options.force_threshold_N = *request.evaluation.force_threshold_N;
  const Objective objective(recording, *predictor, request.metric, options);
  const std::vector<std::size_t> fit_part = objective.part(request.fit_range, "--fit-range");
  const std::vector<std::size_t> score_part = objective.part(request.score_range, "--score-range");

  const Problem problem(objective, inputs.model, parameters, fit_part);
  Progress progress(fmt::format("fitting {}", request.metric), 0);
  const auto metric_at = [&](const std::vector<double>& u) {
    progress.update(problem.evaluations());
    return problem.metric_at(u);
  };
  result.fit_before = objective.value(inputs.model, fit_part);
  const Minimum minimum = minimise(metric_at, start_of(result.estimates));
  result.fit_after = minimum.value;
  result.model = problem.model_at(minimum.u);
  result.model_text = model_to_json(result.model);
  std::vector<double> t_s;
  t_s.reserve(fit_part.size());
  for (const std::size_t i : fit_part) t_s.push_back(recording.motion.t_s[i]);
  const Uncertainty uncertainty =
      sandwich_uncertainty([&](const std::vector<double>& u) { return problem.losses_at(u); }, minimum.u, t_s);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    Estimate& one = result.estimates[i];
    one.value = parameters[i].from_unit(minimum.u[i]);
    one.interval_known = uncertainty.known;
    if (uncertainty.known) {
      one.low95 = parameters[i].from_unit(uncertainty.low_u[i]);
      one.high95 = parameters[i].from_unit(uncertainty.high_u[i]);
    }
    profile(problem, minimum.u, i, one);
  }
  result.interval_note = uncertainty.known ? fmt::format(
                                                 "95 % intervals from the curvature of the loss and the scatter of its "
                                                 "gradient over {} blocks of about {}, because "
                                                 "neighbouring samples are not independent. They say how well this "
                                                 "recording determines the parameter if the "
                                                 "model is right, not how right the model is.",
                                                 uncertainty.blocks, report::display_quantity(uncertainty.block_s, "s"))
                                           : fmt::format("There are no intervals: {}.", uncertainty.why_not);
  warn(minimum.u, result);

  result.score_before = objective.value(inputs.model, score_part);
  result.score_after = objective.value(result.model, score_part);
  result.score_metrics = objective.metrics(result.model, score_part);
  result.metric_unit = find_result(result.score_metrics, request.metric).unit;
  result.signals = signals(recording, objective.predict(result.model));
  result.fit_bands =
      request.fit_range.everything() ? std::vector<std::pair<double, double>>{} : bands(recording, fit_part);
  result.fit_range = request.fit_range.text();
  result.score_range = request.score_range.text();
  result.fit_samples = fit_part.size();
  result.score_samples = score_part.size();
  result.evaluations = problem.evaluations();
  result.title = fmt::format("Fit of {} to {}", request.evaluation.model.renderer,
                             request.evaluation.recording.filename().string());
  result.provenance = report::make_provenance(request.evaluation.command_line);
  result.provenance.inputs = inputs.files;
  result.floor = inputs.floor;
  return result;
}

}  // namespace touchstone::pipeline
