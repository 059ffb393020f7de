// Noise with a memory: an Ornstein-Uhlenbeck process sampled exactly, x_{i+1} = a x_i + sqrt(1 - a^2) sigma w_i with
// a = exp(-dt / tau) (Gillespie 1996, equation 1.9). Stationary: standard deviation sigma, correlation exp(-|lag| /
// tau).
#pragma once

#include "harness/base/random.h"

namespace touchstone::datasets {

class ColouredNoise {
 public:
  // time_constant_s = 0: white.
  ColouredNoise(const Random& stream, double rms, double time_constant_s, double period_s);
  // The next sample of the three independent axes.
  Vec3 next();

 private:
  Random random_;
  double rms_;
  double memory_;
  double fresh_;
  Vec3 state_;
};

}  // namespace touchstone::datasets
