#include "coloured_noise.h"

#include <cmath>

namespace touchstone::datasets {
namespace {

Vec3 normal3(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

}  // namespace

ColouredNoise::ColouredNoise(const Random& stream, double rms, double time_constant_s, double period_s)
    : random_(stream),
      rms_(rms),
      memory_(time_constant_s > 0.0 ? std::exp(-period_s / time_constant_s) : 0.0),
      fresh_(std::sqrt((1.0 - memory_) * (1.0 + memory_))),
      state_(normal3(random_)) {}

Vec3 ColouredNoise::next() {
  Vec3 now = rms_ * state_;
  state_ = memory_ * state_ + fresh_ * normal3(random_);
  return now;
}

}  // namespace touchstone::datasets
