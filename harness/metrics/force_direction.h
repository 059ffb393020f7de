// The force error split into what a hand tells apart: how strong, and which way.
// Magnitude: |rendered| - |measured| in N, over every sample. Angle between the two vectors in degrees, only where both
// are above the force floor: below it the direction is that of the noise.
// Results: rms_force_magnitude_error, bias_force_magnitude_error, mean_force_angle_error, max_force_angle_error.
#pragma once

#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

// The angle in degrees between two vectors that are not zero. By atan2, so that angles near 0 and 180 degrees keep
// their digits (Kahan 2006, "How futile are mindless assessments of roundoff", section 12).
double angle_deg(const Vec3& a, const Vec3& b);

class ForceDirection final : public Metric {
 public:
  explicit ForceDirection(const MetricOptions& options) : floor_N_(options.force_floor_N) {}
  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;

 private:
  double floor_N_;
  Moments magnitude_;
  Moments measured_;
  Moments angle_;
  SeriesRecorder angle_series_{"angle between measured and rendered force", "deg"};
};

}  // namespace touchstone::metrics
