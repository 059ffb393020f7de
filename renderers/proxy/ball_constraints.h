// A ball that touches triangles: where its centre comes to rest when the tip pulls it to p.
//
// The centre keeps the distance r from each triangle, as a convex set: from its face, an edge or a corner, whichever is
// closest. Up to three triangles hold it at rest. Templates over the mesh, whose scalar may be the one that counts
// (counted_contact_mesh.h).
#pragma once

#include <array>
#include <cstdint>

#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

// The triangle's closest point seen from x, the centre of a ball.
template <class S>
struct TouchOf {
  Vec3Of<S> n;               // unit, from the closest point to x
  S d;                       // distance
  surface::Feature feature;  // face, edge or vertex of the triangle
  std::uint8_t index;
};

template <class Mesh, class S = typename Mesh::Scalar>
TouchOf<S> touch(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& x) noexcept;

// Whether the triangle, of nonzero area, comes as close to x as that: the same answer whatever tree proposed it.
template <class Mesh, class S = typename Mesh::Scalar>
bool comes_within(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& x, const S& reach) noexcept;

// Whether the triangle, of nonzero area, is farther from x than that by its plane and borders alone: without its
// corners, which lie elsewhere in memory. False does not say that it comes as close.
template <class Mesh, class S = typename Mesh::Scalar>
bool surely_beyond(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& x, const S& reach) noexcept;

// Whether the way from a to b keeps the distance from the triangle.
template <class Mesh, class S = typename Mesh::Scalar>
bool stays_clear(const Mesh& mesh, std::int32_t triangle, const Vec3Of<S>& a, const Vec3Of<S>& b,
                 const S& distance) noexcept;

// The triangles that hold a ball.
struct Holding {
  std::array<std::int32_t, 3> triangle{-1, -1, -1};
  int size = 0;

  [[nodiscard]] bool has(std::int32_t t) const noexcept {
    for (int i = 0; i < size; ++i) {
      if (triangle[static_cast<std::size_t>(i)] == t) return true;
    }
    return false;
  }
  void add(std::int32_t t) noexcept { triangle[static_cast<std::size_t>(size++)] = t; }
};

// The point at distance r from every triangle of `holding` at which |x - p| is least, near x (which is where the search
// starts and gets the answer): closed forms for a single triangle, Newton's method on the multipliers' equations
//   x - p = sum l_i n_i(x),  d_i(x) = r
// for several, and in a nearly flat crease, where that does not settle, two planes in closed form. False where it does
// not converge, leaves the side of the triangle on which it started, or a triangle would pull (l_i < 0).
template <class Mesh, class S = typename Mesh::Scalar>
bool rest_on(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& p, const S& rounding,
             Vec3Of<S>& x) noexcept;

// Where a ball at x should go that is pulled to p and comes there too slowly: p, or, if it hangs on an edge or corner
// that lies between it and p, the place in the same direction from there that is a radius away. A ball turns about an
// edge by way over radius: to a p beside the edge's line it would turn by next to nothing, and where it rests on the
// arc depends on the direction alone.
template <class Mesh, class S = typename Mesh::Scalar>
Vec3Of<S> way_round(const Mesh& mesh, const Holding& holding, const S& r, const Vec3Of<S>& x, const Vec3Of<S>& p,
                    const S& rounding) noexcept;

}  // namespace touchstone::renderers
