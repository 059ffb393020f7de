// Output position error: the distance between the surface contact point that the renderer answered and the
// out-trajectory, in m. Source: Ruffaldi et al. 2006, section 3.3.
// Results: rms_position_error (with its series and histogram), mean_position_error, max_position_error.
#pragma once

#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

class PositionError final : public Metric {
 public:
  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;

 private:
  Moments error_;
  SeriesRecorder series_{"position error", "m"};
  HistogramRecorder histogram_{"m"};
};

}  // namespace touchstone::metrics
