#include "harness/metrics/force_error.h"

#include "harness/metrics/result.h"

namespace touchstone::metrics {

void ForceError::add(const MetricSample& sample) {
  const double error = (sample.f_measured_W_N - sample.f_rendered_W_N).norm();
  error_.add(sample.t_s, error);
  measured_.add(sample.t_s, sample.f_measured_W_N.norm());
  series_.add(sample.t_s, error);
  histogram_.add(error);
}

std::vector<MetricResult> ForceError::results() {
  auto rms = make_result("rms_force_error", "N",
                         "Root mean square of the distance between the measured and the rendered force vector "
                         "(what the tables of the 2006 paper list).",
                         error_.rms(), error_);
  set_reference(rms, measured_.rms(), "RMS of the measured force: the score of a renderer that always answers zero");
  rms.series = series_.series();
  rms.histogram = histogram_.histogram();
  auto mean = make_result("mean_force_error", "N",
                          "Mean distance between the measured and the rendered force vector (equation 3 of the 2006 "
                          "paper as it is printed).",
                          error_.mean(), error_);
  set_reference(mean, measured_.mean(), "mean magnitude of the measured force");
  auto most =
      make_result("max_force_error", "N", "The largest distance between the two force vectors.", error_.peak(), error_);
  set_reference(most, measured_.peak(), "largest measured force");
  if (most.status == MetricStatus::ok) most.t_s = error_.peak_t_s();
  return {std::move(rms), std::move(mean), std::move(most)};
}

}  // namespace touchstone::metrics
