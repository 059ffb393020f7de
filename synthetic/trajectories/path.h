// A motion of the tip as a deterministic function of time, in the object's frame. The surfaces' touched side is z = 0
// with the outside above, so depths are negative z.
#pragma once

#include "harness/recording/trajectory.h"

namespace touchstone::synthetic {

class Path {
 public:
  virtual ~Path() = default;
  // For 0 <= t <= duration; held at the ends beyond.
  [[nodiscard]] virtual Vec3 position_W_m(double t_s) const = 0;
  [[nodiscard]] virtual double duration_s() const = 0;
};

// Samples t = i / rate from 0 to the duration, its end included where it falls on a sample.
// Throws UsageError for a rate or duration that makes no sample or more than 100 million.
recording::InTrajectory sample(const Path& path, double rate_Hz);

// From 0 to 1 with vanishing speed and acceleration at both ends: the minimum-jerk profile 10 s^3 - 15 s^4 + 6 s^5
// (Flash and Hogan 1985, appendix A). 0 before and 1 after.
double minimum_jerk(double fraction) noexcept;

// Goes to and fro between 0 and 1 at constant speed: 0 at 0, 1 at 1, 0 at 2.
double to_and_fro(double passes) noexcept;

}  // namespace touchstone::synthetic
