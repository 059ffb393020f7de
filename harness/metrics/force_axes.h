// Force error along each axis of the object's frame, in N: RMS, and the bias (mean of rendered minus measured), which
// tells a constant offset of the sensor from errors that come and go.
// Results: rms_force_error_{x,y,z}, bias_force_error_{x,y,z}.
#pragma once

#include <array>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

class ForceAxes final : public Metric {
 public:
  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;

 private:
  std::array<Moments, 3> error_;
  std::array<Moments, 3> measured_;
};

}  // namespace touchstone::metrics
