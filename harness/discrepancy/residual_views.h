// What a model leaves, looked at from many sides: groups of forces that something outside the library might make, each
// group a flexible function of one thing (how deep, how fast, where, when, what came before). A regression on a group
// may detect that something is missing and from which side it shows; it is never added to a model. All features turn
// with the world, and none has a unit of its own: sizes are measured on the training recording, so that a feature is
// the same function in both recordings.
#pragma once

#include <string>
#include <vector>

#include "harness/discrepancy/residual_blocks.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

struct ViewScales {
  double depth_m = 0.0;             // 95th percentile in contact
  double depth_rate_m_per_s = 0.0;  // 90th
  double speed_m_per_s = 0.0;       // along the surface, 80th
  double load_N = 0.0;              // 95th
  double extent_m = 0.0;            // diagonal of what was touched
  double duration_s = 0.0;
  Vec3 middle_W_m = Vec3::Zero();
};

ViewScales measure_view_scales(const MotionColumns& motion, const rendering::Prediction& prediction);

struct ResidualView {
  std::string name;                      // for a reader: "depth", "time", ...
  std::vector<std::vector<Vec3>> means;  // over each block, of forces of any size
};

// A hundred forces of every sample would need more memory than all the rest of a search: only one of them is there at a
// time. `blocks` are of `motion`.
std::vector<ResidualView> residual_views(const MotionColumns& motion, const rendering::Prediction& prediction,
                                         const ViewScales& scales, const std::vector<ResidualBlock>& blocks);

}  // namespace touchstone::discrepancy
