// Is the force written in another frame than the object's? Under friction the force on the probe stays near the outward
// normal; turned by the wrong rotation it does not. Each reading is tried: the force in the sensor's frame, turned the
// wrong way round, quaternion with its scalar last, and each of them reversed; and the axes mirrored or exchanged, in
// all 48 signed orders. Friction alone can lean a force so that a mirrored axis brings it nearer to the normal, on a
// slope that is only ever climbed: an order is named if the force as recorded lies outside a coefficient of 0.5.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "harness/base/vec.h"

namespace touchstone::recording_checks {

struct ForceFrame {
  std::string meaning;     // "the force is in the sensor's frame"
  std::string map_key;     // what a map of `touchstone import` says to repair it
  double alignment = 0.0;  // sum of f.n over sum of |f|, as recorded
  double repaired = 0.0;   // and so read
};

// One normal (outward), force and orientation for each sample; nothing where the recording's own reading is as good as
// any. A reading must take away more than half of the misalignment, in the great majority of 20 blocks of the recording
// (sign test, p < 0.01), and leave the force within the friction cone of a coefficient of 0.75.
std::optional<ForceFrame> find_force_frame(std::span<const Vec3> normals, std::span<const Vec3> forces,
                                           std::span<const Quat> q_WS, double most_left = 0.5);

}  // namespace touchstone::recording_checks
