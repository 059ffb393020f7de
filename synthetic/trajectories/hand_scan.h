// A hand that explores: minimum-jerk reaches (Flash and Hogan 1985) between seeded places in a square, pressed to a
// seeded depth, with tremor on top.
#pragma once

#include <cstdint>
#include <vector>

#include "synthetic/trajectories/path.h"
#include "synthetic/trajectories/tremor.h"

namespace touchstone::synthetic {

class HandScanPath final : public Path {
 public:
  // `depth_m` is the mean depth of the reaches' ends; every third reach ends above the surface by as much.
  HandScanPath(std::uint64_t seed, double side_m, double depth_m, double reaches, double reach_s, double tremor_m);
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override { return reach_s_ * static_cast<double>(places_W_m_.size() - 1); }

 private:
  std::vector<Vec3> places_W_m_;
  double reach_s_;
  Tremor tremor_m_;
};

}  // namespace touchstone::synthetic
