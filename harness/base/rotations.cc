#include "harness/base/rotations.h"

namespace touchstone {

Quat shortest_rotation(const Vec3& from, const Vec3& to) { return Quat::FromTwoVectors(from, to); }

}  // namespace touchstone
