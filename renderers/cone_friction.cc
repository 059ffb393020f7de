#include "renderers/cone_friction.h"

namespace touchstone {

ConeSplit split_by_normals(const ContactNormals& contact, const Vec3& way, double rounding) noexcept {
  if (contact.size == 0) return {way, Vec3::Zero()};
  if (contact.size == 1) {
    const double height = contact.n[0].dot(way);
    if (height >= 0.0) return {way, Vec3::Zero()};
    const Vec3 normal = -height * contact.n[0];
    return {way + normal, normal};
  }
  std::array<HalfSpace, 3> sides;
  for (int i = 0; i < contact.size; ++i)
    sides[static_cast<std::size_t>(i)] = {contact.n[static_cast<std::size_t>(i)], 0.0};
  const auto nearest =
      nearest_in_polyhedron(std::span(sides.data(), static_cast<std::size_t>(contact.size)), way, rounding);
  // Normals too much alike to be told apart: all of the pull presses.
  if (!nearest.found) return {Vec3::Zero(), -way};
  return {nearest.x, nearest.x - way};
}

}  // namespace touchstone
