#include "force_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coloured_noise.h"

namespace touchstone::datasets {

ForceSensor ForceSensor::perfect() {
  ForceSensor sensor;
  sensor.step_N = Vec3::Zero();
  sensor.limit_N = Vec3::Constant(std::numeric_limits<double>::infinity());
  sensor.coloured_noise_N = 0.0;
  sensor.white_noise_N = 0.0;
  sensor.drift_N_per_sqrt_s = 0.0;
  return sensor;
}

ForceMeasurement ForceSensor::measure(const std::function<Vec3(double)>& force_S_N, double duration_s,
                                      std::uint64_t seed) const {
  const double period = 1.0 / rate_Hz;
  // One stream for each effect: switching one off leaves the others' values as they were.
  const Random root(seed);
  ColouredNoise coloured(root.stream(0), coloured_noise_N, noise_time_constant_s, period);
  ColouredNoise white(root.stream(1), white_noise_N, 0.0, period);
  ColouredNoise steps(root.stream(2), drift_N_per_sqrt_s * std::sqrt(period), 0.0, period);
  ForceMeasurement out;
  Vec3 drift = Vec3::Zero();
  const auto count = static_cast<std::size_t>(std::floor(duration_s * rate_Hz * (1.0 + 1e-12))) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    const Vec3 truth = force_S_N(t);
    const Vec3 bias = bias_N + drift;
    const Vec3 noise = coloured.next() + white.next();
    const Vec3 gauge = truth + bias + noise;
    const Vec3 within = gauge.cwiseMax(-limit_N).cwiseMin(limit_N);
    Vec3 read = within;
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (step_N[k] > 0.0) read[k] = step_N[k] * std::round(within[k] / step_N[k]);
    }
    drift += steps.next();
    out.t_s.push_back(t);
    out.truth_S_N.push_back(truth);
    out.bias_S_N.push_back(bias);
    out.noise_S_N.push_back(noise);
    out.clipping_S_N.push_back(within - gauge);
    out.rounding_S_N.push_back(read - within);
    out.measured_S_N.push_back(read);
  }
  return out;
}

}  // namespace touchstone::datasets
