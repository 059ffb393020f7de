// A six-axis force sensor as of Ruffaldi et al. 2006, section 2: an ATI Nano17 read at 5 kHz through a 16-bit
// converter. Its effects act in the order in which the instrument has them: bias and drift of the strain gauges, noise,
// the range's end, rounding to the step. Each is switched off by its zero (saturation by infinity), and what each added
// is kept.
#pragma once

#include <cstdint>
#include <functional>

#include "measurement.h"

namespace touchstone::datasets {

struct ForceSensor {
  double rate_Hz = 5000.0;
  // The paper gives 1/320 N for x and y and 1/640 N for z, along the probe.
  Vec3 step_N{1.0 / 320.0, 1.0 / 320.0, 1.0 / 640.0};
  // The range that goes with these steps (calibration SI-12-0.12): 12 N across, 17 N along.
  Vec3 limit_N{12.0, 12.0, 17.0};
  // Our choice, about the step: the makers state the resolution, not the noise.
  double coloured_noise_N = 0.003;
  double noise_time_constant_s = 0.01;
  double white_noise_N = 0.003;
  Vec3 bias_N = Vec3::Zero();
  // A random walk of this growth, N per square root of a second.
  double drift_N_per_sqrt_s = 0.001;

  // Nothing added: measured is the truth to the bit.
  static ForceSensor perfect();

  // Samples at i / rate for i = 0 .. while <= duration. `force_S_N` gives the true force in the sensor's frame.
  [[nodiscard]] ForceMeasurement measure(const std::function<Vec3(double t_s)>& force_S_N, double duration_s,
                                         std::uint64_t seed) const;
};

}  // namespace touchstone::datasets
