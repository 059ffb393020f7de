#include "harness/pipeline/fitting/objective.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "harness/base/error.h"
#include "harness/rendering/predictor.h"

namespace touchstone::pipeline {
using metrics::MetricResult;
using rendering::Model;

namespace {

std::vector<std::string> force_metrics() {
  std::vector<std::string> out;
  for (const metrics::MetricEntry& entry : metrics::metric_catalogue()) {
    if (entry.needs_force && !entry.needs_position && !entry.needs_cost) out.push_back(entry.name);
  }
  return out;
}

}  // namespace

void check_fit_metric(const std::string& metric) {
  const metrics::MetricEntry& entry = metrics::find_metric(metric);
  if (entry.name == metric && entry.results.size() > 1) {
    throw UsageError(
        fmt::format("--metric {} has several results; name one of them, such as {}", metric, entry.results.front()));
  }
  if (!entry.needs_force || entry.needs_position || entry.needs_cost) {
    throw UsageError(
        fmt::format("--metric {}: a fit compares forces; choose a force metric such as rms_force_error", metric));
  }
}

Objective::Objective(const recording::Recording& recording, rendering::Predictor& predictor, std::string metric,
                     const metrics::MetricOptions& options)
    : recording_(recording), predictor_(predictor), metric_(std::move(metric)), options_(options) {
  check_fit_metric(metric_);
  loss_ = loss_of(metric_);
  if (loss_ == Loss::square_of_axis) axis_ = metric_.back() - 'x';
}

Objective::Loss Objective::loss_of(const std::string& metric) {
  if (metric == "mean_force_error") return Loss::distance;
  if (metric == "rms_force_error") return Loss::square;
  return metric.starts_with("rms_force_error_") ? Loss::square_of_axis : Loss::none;
}

std::vector<MetricResult> Objective::metrics(const Model& model, const std::vector<std::size_t>& part) const {
  const std::vector<Vec3> forces = predict(model);
  metrics::MetricSet set(force_metrics(), {true, false, false}, options_);
  metrics::MetricSample sample;
  for (const std::size_t i : part) {
    sample.t_s = recording_.motion.t_s[i];
    sample.f_measured_W_N = recording_.f_W_N[i];
    sample.f_rendered_W_N = forces[i];
    set.add(sample);
  }
  return set.results();
}

double Objective::value(const Model& model, const std::vector<std::size_t>& part) const {
  const std::vector<double> loss = losses(model, part);
  if (!loss.empty()) {
    metrics::CompensatedSum sum;
    for (const double one : loss) sum.add(one);
    const double mean = sum.value() / static_cast<double>(part.size());
    if (!std::isfinite(mean))
      throw BadData(fmt::format("{}: {} has no value on these samples", recording_.source, metric_));
    return loss_ == Loss::distance ? mean : std::sqrt(mean);
  }
  const std::vector<MetricResult> results = metrics(model, part);
  const MetricResult& result = find_result(results, metric_);
  if (result.status != metrics::MetricStatus::ok) {
    throw BadData(fmt::format("{}: {} has no value on these samples: {}", recording_.source, metric_, result.note));
  }
  return std::abs(result.value);
}

std::vector<double> Objective::losses(const Model& model, const std::vector<std::size_t>& part) const {
  if (loss_ == Loss::none) return {};
  const std::vector<Vec3> forces = predict(model);
  std::vector<double> out;
  out.reserve(part.size());
  for (const std::size_t i : part) {
    const Vec3 error = recording_.f_W_N[i] - forces[i];
    out.push_back(loss_ == Loss::distance ? error.norm()
                  : loss_ == Loss::square ? error.squaredNorm()
                                          : error[axis_] * error[axis_]);
  }
  return out;
}

std::vector<std::size_t> Objective::part(const metrics::TimeRanges& ranges, const std::string& option) const {
  std::vector<std::size_t> out;
  const std::vector<double>& t_s = recording_.motion.t_s;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (ranges.contains(t_s[i], t_s.front())) out.push_back(i);
  }
  if (out.size() < 10) {
    throw UsageError(fmt::format("{} {}: only {} samples of {} lie in it; the recording is from {} s to {} s", option,
                                 ranges.text(), out.size(), recording_.source, t_s.front(), t_s.back()));
  }
  return out;
}

}  // namespace touchstone::pipeline
