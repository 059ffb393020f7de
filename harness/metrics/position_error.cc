#include "harness/metrics/position_error.h"

#include "harness/metrics/result.h"

namespace touchstone::metrics {

void PositionError::add(const MetricSample& sample) {
  const double error = (sample.contact_W_m - sample.out_W_m).norm();
  error_.add(sample.t_s, error);
  series_.add(sample.t_s, error);
  histogram_.add(error);
}

std::vector<MetricResult> PositionError::results() {
  auto rms = make_result("rms_position_error", "m",
                         "Root mean square of the distance between the rendered surface contact point and the "
                         "out-trajectory (where the real probe was).",
                         error_.rms(), error_);
  rms.series = series_.series();
  rms.histogram = histogram_.histogram();
  auto mean = make_result("mean_position_error", "m", "Mean of that distance.", error_.mean(), error_);
  auto most = make_result("max_position_error", "m", "The largest of those distances.", error_.peak(), error_);
  if (most.status == MetricStatus::ok) most.t_s = error_.peak_t_s();
  return {std::move(rms), std::move(mean), std::move(most)};
}

}  // namespace touchstone::metrics
