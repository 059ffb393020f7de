// Where a rigid body, or the tip of a probe, was over time. SI units; the object's (world) frame W.
#pragma once

#include <cstddef>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone {

// Time and pose of a body; of a probe, its tip's (the ball's centre where the tip is a ball). All filled vectors have
// the same length.
struct MotionColumns {
  std::vector<double> t_s;  // strictly increasing
  std::vector<Vec3> p_W_m;  // tip position
  std::vector<Quat> q_WS;   // turns the sensor's frame into the object's; empty where not recorded

  [[nodiscard]] std::size_t size() const noexcept { return t_s.size(); }
};

}  // namespace touchstone
