// Output force error: the Euclidean distance between the measured and the rendered force, in N.
// Source: Ruffaldi et al. 2006, section 3.3, equation 3. The equation as printed is the mean of the distances,
// e = 1/N sum |Fp_i - Fr_i|; the text and the tables call it the RMS. They differ, so both are given under their names.
// Results: rms_force_error (with its series and histogram), mean_force_error, max_force_error.
#pragma once

#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

class ForceError final : public Metric {
 public:
  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;

 private:
  Moments error_;
  Moments measured_;
  SeriesRecorder series_{"force error", "N"};
  HistogramRecorder histogram_{"N"};
};

}  // namespace touchstone::metrics
