#include "renderers/friction/cone_split.h"

#include "harness/base/counted.h"
#include "renderers/friction/fixed_order.h"
#include "renderers/friction/nearest_in_polyhedron.h"

namespace touchstone::renderers {
namespace {

// The sum of the l_i in normal = sum l_i n_i over two or three normals; the length of `normal` where they are too much
// alike to be told apart.
template <class S>
S sum_of_multiples(const NearestInPolyhedronOf<S>& nearest, const ContactNormalsOf<S>& contact,
                   const Vec3Of<S>& normal) noexcept {
  const auto n = [&](std::size_t i) -> const Vec3Of<S>& {
    return contact.n[static_cast<std::size_t>(nearest.basis[i])];
  };
  if (nearest.basis_size == 2) {
    // n_1 . normal = l_1 + c l_2 and n_2 . normal = c l_1 + l_2, added.
    const S both = S(1.0) + dot(n(0), n(1));
    if (both > S(0.0)) return (dot(n(0), normal) + dot(n(1), normal)) / both;
  } else if (nearest.basis_size == 3) {
    Eigen::Matrix<S, 3, 3> normals;
    normals << n(0), n(1), n(2);
    Eigen::Matrix<S, 3, 3> inverse;
    if (invert<S>(normals, 1e-12, inverse)) {
      const Vec3Of<S> multiples = product(inverse, normal);
      return multiples.x() + multiples.y() + multiples.z();
    }
  }
  return norm(normal);
}

}  // namespace

template <class S>
ConeSplitOf<S> split_by_normals(const ContactNormalsOf<S>& contact, const Vec3Of<S>& way, const S& rounding) noexcept {
  const Vec3Of<S> none = Vec3Of<S>::Zero();
  if (contact.size == 0) return {way, none, S(0.0)};
  if (contact.size == 1) {
    const S height = dot(contact.n[0], way);
    if (height >= S(0.0)) return {way, none, S(0.0)};
    const Vec3Of<S> normal = -height * contact.n[0];
    return {way + normal, normal, norm(normal)};
  }
  std::array<HalfSpaceOf<S>, 3> sides;
  for (int i = 0; i < contact.size; ++i)
    sides[static_cast<std::size_t>(i)] = {contact.n[static_cast<std::size_t>(i)], S(0.0)};
  const auto nearest =
      nearest_in_polyhedron_of<S>({sides.data(), static_cast<std::size_t>(contact.size)}, way, rounding);
  // Normals too much alike to be told apart: all of the pull presses.
  if (!nearest.found) return {none, -way, norm(way)};
  const Vec3Of<S> normal = nearest.x - way;
  return {nearest.x, normal, sum_of_multiples(nearest, contact, normal)};
}

template ConeSplitOf<double> split_by_normals(const ContactNormals&, const Vec3&, const double&) noexcept;
template ConeSplitOf<Counted> split_by_normals(const ContactNormalsOf<Counted>&, const Vec3Of<Counted>&,
                                               const Counted&) noexcept;

}  // namespace touchstone::renderers
