// Computational cost of one step of the renderer, in microseconds: mean, median, 99th percentile, maximum.
// Source: Ruffaldi et al. 2006, section 3.3 (mean, median and maximum; there in floating-point operations, which modern
// processors do not count reliably: here the time on this machine, which compares renderers within one run only).
// Results: mean_step_cost, median_step_cost, p99_step_cost, max_step_cost.
#pragma once

#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"
#include "harness/metrics/quantiles.h"

namespace touchstone::metrics {

class StepCost final : public Metric {
 public:
  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;

 private:
  Moments cost_;
  Quantiles quantiles_;
  SeriesRecorder series_{"cost of a step", "us"};
  HistogramRecorder histogram_{"us"};
};

}  // namespace touchstone::metrics
