#include "harness/metrics/force_direction.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "harness/metrics/result.h"

namespace touchstone::metrics {

double angle_deg(const Vec3& a, const Vec3& b) {
  const Vec3 u = a.stableNormalized();
  const Vec3 v = b.stableNormalized();
  return 2.0 * std::atan2((u - v).norm(), (u + v).norm()) * 180.0 / std::numbers::pi;
}

void ForceDirection::add(const MetricSample& sample) {
  const double measured = sample.f_measured_W_N.norm();
  const double rendered = sample.f_rendered_W_N.norm();
  magnitude_.add(sample.t_s, rendered - measured);
  measured_.add(sample.t_s, measured);
  if (!std::isfinite(rendered - measured)) {
    angle_.add(sample.t_s, std::nan(""));
  } else if (measured >= floor_N_ && rendered >= floor_N_ && measured > 0.0 && rendered > 0.0) {
    const double angle = angle_deg(sample.f_measured_W_N, sample.f_rendered_W_N);
    angle_.add(sample.t_s, angle);
    angle_series_.add(sample.t_s, angle);
  }
}

std::vector<MetricResult> ForceDirection::results() {
  auto rms = make_result("rms_force_magnitude_error", "N",
                         "Root mean square of the difference of the two forces' magnitudes, whatever their direction.",
                         magnitude_.rms(), magnitude_);
  set_reference(rms, measured_.rms(), "RMS of the measured force");
  auto bias = make_result("bias_force_magnitude_error", "N",
                          "Mean of rendered minus measured magnitude: above 0 the renderer is too strong.",
                          magnitude_.mean(), magnitude_);
  set_reference(bias, measured_.mean(), "mean magnitude of the measured force");
  auto mean = make_result("mean_force_angle_error", "deg", "Mean angle between the measured and the rendered force.",
                          angle_.mean(), angle_);
  auto most =
      make_result("max_force_angle_error", "deg", "The largest angle between the two forces.", angle_.peak(), angle_);
  if (most.status == MetricStatus::ok) most.t_s = angle_.peak_t_s();
  const std::string floor = fmt::format("where both forces are at least {:.4g} N: {} of {} samples", floor_N_,
                                        angle_.count(), magnitude_.count());
  for (auto* const result : {&mean, &most}) {
    if (result->status != MetricStatus::invalid) result->note = floor;
  }
  mean.series = angle_series_.series();
  return {std::move(rms), std::move(bias), std::move(mean), std::move(most)};
}

}  // namespace touchstone::metrics
