#include "harness/metrics/step_cost.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/metrics/result.h"

namespace touchstone::metrics {

void StepCost::add(const MetricSample& sample) {
  cost_.add(sample.t_s, sample.cost_us);
  if (std::isfinite(sample.cost_us)) quantiles_.add(sample.cost_us);
  series_.add(sample.t_s, sample.cost_us);
  histogram_.add(sample.cost_us);
}

std::vector<MetricResult> StepCost::results() {
  auto mean = make_result("mean_step_cost", "us", "Mean time of one step of the renderer.", cost_.mean(), cost_);
  mean.series = series_.series();
  mean.histogram = histogram_.histogram();
  auto median =
      make_result("median_step_cost", "us", "Half of the steps take no longer.", quantiles_.quantile(0.5), cost_);
  auto p99 = make_result("p99_step_cost", "us", "99 of 100 steps take no longer.", quantiles_.quantile(0.99), cost_);
  for (auto* const result : {&median, &p99}) {
    if (result->status == MetricStatus::ok) {
      result->note = fmt::format("within {:.1g} % of the sample of that rank", 100.0 * Quantiles::relative_error);
    }
  }
  auto most = make_result("max_step_cost", "us", "The longest step: above 1000 us a 1 kHz servo loop misses its tick.",
                          cost_.peak(), cost_);
  if (most.status == MetricStatus::ok) most.t_s = cost_.peak_t_s();
  return {std::move(mean), std::move(median), std::move(p99), std::move(most)};
}

}  // namespace touchstone::metrics
