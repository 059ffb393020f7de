// An optical tracker as of Ruffaldi et al. 2006, section 2: six cameras at 60 Hz, position better than 0.5 mm. Its
// error has a part anew for every sample and a part that wanders slowly, as calibration residuals do while the probe
// moves through the volume; its clock may jitter and its stamps may lag. Each effect is switched off by its zero.
#pragma once

#include <cstdint>
#include <functional>

#include "measurement.h"

namespace touchstone::datasets {

struct Tracker {
  double rate_Hz = 60.0;
  // Together 0.09 mm on every axis: 0.5 mm is then more than 3 standard deviations of each axis away.
  double noise_m = 4e-5;
  double wander_m = 8e-5;
  double wander_time_constant_s = 4.0;
  double orientation_noise_rad = 0.001;
  // Exposures come this much (uniformly) off their period and are stamped when they happened; less than half a period.
  double jitter_s = 0.0;
  // Stamps are later than the exposure.
  double lag_s = 0.0;

  static Tracker perfect();

  struct Pose {
    Vec3 p_W_m;
    Quat q_WS;
  };
  // Samples at i / rate for i = 0 .. while <= duration.
  [[nodiscard]] PoseMeasurement measure(const std::function<Pose(double t_s)>& pose, double duration_s,
                                        std::uint64_t seed) const;
};

}  // namespace touchstone::datasets
