// Rotations that many rooms need. In a file of its own, because the code of Eigen's that it calls takes some ten
// seconds to compile in every unit that calls it.
#pragma once

#include "harness/base/vec.h"

namespace touchstone {

// The shortest rotation that turns the direction of `from` into that of `to`, both of any length but zero; half a turn
// about some axis across them where they are opposite. Eigen's Quaterniond::FromTwoVectors.
Quat shortest_rotation(const Vec3& from, const Vec3& to);

}  // namespace touchstone
