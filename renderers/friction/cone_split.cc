#include "renderers/friction/cone_split.h"

#include "harness/base/counted.h"
#include "renderers/friction/nearest_in_polyhedron.h"

namespace touchstone::renderers {

template <class S>
ConeSplitOf<S> split_by_normals(const ContactNormalsOf<S>& contact, const Vec3Of<S>& way, const S& rounding) noexcept {
  const Vec3Of<S> none = Vec3Of<S>::Zero();
  if (contact.size == 0) return {way, none};
  if (contact.size == 1) {
    const S height = dot(contact.n[0], way);
    if (height >= S(0.0)) return {way, none};
    const Vec3Of<S> normal = -height * contact.n[0];
    return {way + normal, normal};
  }
  std::array<HalfSpaceOf<S>, 3> sides;
  for (int i = 0; i < contact.size; ++i)
    sides[static_cast<std::size_t>(i)] = {contact.n[static_cast<std::size_t>(i)], S(0.0)};
  const auto nearest =
      nearest_in_polyhedron_of<S>({sides.data(), static_cast<std::size_t>(contact.size)}, way, rounding);
  // Normals too much alike to be told apart: all of the pull presses.
  if (!nearest.found) return {none, -way};
  return {nearest.x, nearest.x - way};
}

template ConeSplitOf<double> split_by_normals(const ContactNormals&, const Vec3&, const double&) noexcept;
template ConeSplitOf<Counted> split_by_normals(const ContactNormalsOf<Counted>&, const Vec3Of<Counted>&,
                                               const Counted&) noexcept;

}  // namespace touchstone::renderers
