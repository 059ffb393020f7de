// What other authors' metrics say of a pair.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/perception/distances/vibration_similarity.h"
#include "harness/perception/filters/stevens_power_law.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
namespace {

OtherMetric metric_of(std::string name, std::string unit, bool larger_is_better) {
  return {std::move(name), std::move(unit), larger_is_better, std::nullopt, {}};
}

template <class Value>
OtherMetric tried(OtherMetric metric, Value&& value) {
  try {
    metric.value = value();
    if (metric.value && !std::isfinite(*metric.value)) metric.value.reset();
    if (!metric.value) metric.why = "undefined for these recordings";
  } catch (const Error& error) {
    metric.why = error.what();
  }
  return metric;
}

}  // namespace

std::vector<OtherMetric> other_metrics(const recording::Recording& real, const recording::Recording& rendered,
                                       const Vec3& outward) {
  std::vector<OtherMetric> metrics;
  const double contact_N = fingertip_force.absolute_threshold;
  EvaluationOptions options;
  options.explained_share = 1.0;
  options.threads = 1;
  OtherMetric space = metric_of(std::string(perception_space_method.name), std::string(perception_space_method.unit),
                                perception_space_method.larger_is_better);
  std::vector<double> real_N;
  std::vector<double> rendered_N;
  double rate_Hz = 0.0;
  try {
    const auto evaluation =
        evaluate({press_signal(real, outward, contact_N)},
                 {{"condition", [&] { return std::vector{press_signal(rendered, outward, contact_N)}; }}}, options);
    space.value = evaluation.conditions.front().distance;
    const auto& statistics = evaluation.conditions.front().statistics;
    metrics.push_back(space);
    for (std::size_t m = 0; m < statistics.size(); ++m) {
      const Method& method = statistical_methods()[m].method;
      metrics.push_back({std::string(method.name), std::string(method.unit), method.larger_is_better, statistics[m],
                         statistics[m] ? "" : "undefined for these recordings"});
    }
    real_N = evaluation.rendered_N.at(0);
    rendered_N = evaluation.rendered_N.at(1);
    rate_Hz = evaluation.rate_Hz;
  } catch (const BadData& error) {
    space.why = error.what();
    metrics.push_back(space);
    for (const auto& own : statistical_methods()) {
      metrics.push_back({std::string(own.method.name), std::string(own.method.unit), own.method.larger_is_better,
                         std::nullopt, error.what()});
    }
  }
  const auto needs_series = [&] {
    if (real_N.empty()) throw BadData(space.why);
  };
  VibrationSettings settings;
  settings.rate_Hz = rate_Hz;
  metrics.push_back(tried(metric_of("st-sim", "1", true), [&]() -> std::optional<double> {
    needs_series();
    return spectral_temporal_similarity(real_N, rendered_N, settings);
  }));
  metrics.push_back(tried(metric_of("spqi", "1", true), [&]() -> std::optional<double> {
    needs_series();
    return spectral_perceptual_quality_index(real_N, rendered_N, settings);
  }));
  // Root mean square difference of felt intensity over that of the real process (Stevens 1957, exponent of muscle
  // force): the law's factor cancels.
  metrics.push_back(tried(metric_of("stevens", "1", false), [&]() -> std::optional<double> {
    needs_series();
    const StevensPowerLaw law{1.0, stevens_muscle_force};
    double apart = 0.0;
    double own = 0.0;
    for (std::size_t i = 0; i < real_N.size(); ++i) {
      apart += std::pow(law(rendered_N[i]) - law(real_N[i]), 2);
      own += std::pow(law(real_N[i]), 2);
    }
    return own > 0.0 ? std::optional(std::sqrt(apart / own)) : std::nullopt;
  }));
  return metrics;
}

}  // namespace touchstone::perception
