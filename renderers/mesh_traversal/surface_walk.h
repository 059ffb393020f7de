// The god-object of a point tip: the point that follows the tip outside the surface, always at the least distance from
// it that can be reached by descending over the surface from where it was.
//
// Source: C. B. Zilles and J. K. Salisbury, "A constraint-based god-object method for haptic display", IROS 1995:
// contact by the path of the god-object rather than of the tip (their section 3), distance to the tip minimised under
// one, two or three active planes (section 4, equations 1-4: the minimum of |x - p|^2/2 with Lagrange multipliers for
// the planes). Their planes are unbounded while active and are found by intersecting the path with the surface. Here
// the active planes follow from where on the mesh the god-object is: on a face one is active, on a concave edge two, at
// a vertex the planes about it, which makes their system of multipliers small enough to be written out:
//   face:    x = p - h n, multiplier -h > 0, h the tip's height over the plane;
//   edge:    x = foot of p on the edge; both multipliers are positive exactly where p lies under neither face's strip;
//   vertex:  x = the vertex, where no face's strip and no edge's slab holds p.
// The god-object moves between these by index over neighbouring triangles, so that no distance has to be called small:
// nothing here depends on the unit, on the size of triangles or on how flat an edge is. Only when it leaves the surface
// does a segment query look for what it meets next.
//
// One-sided: triangles stop what comes from the side that their normal points to. A tip that slides off the rim of an
// open mesh, or comes from behind, is free: the inside of an open mesh is not defined, and a closed one is never
// entered.
//
// With friction (cone_friction.h) the god-object stays where the cone holds it, on a face or along a valley's edge (by
// the cones of both walls), and
// else goes only as far towards the tip's foot point as the cone lets it. A ridge's edge holds nothing by itself: each
// face is asked, the steeper first, and where that one holds the other does too.
//
// The mesh must be manifold about the triangles that the god-object touches, and not cross itself there; see
// Facet::regular.
#pragma once

#include <cstdint>

#include "renderers/friction/cone_friction.h"
#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

// Over any mesh with the members of ContactMesh that it uses: ContactMesh itself, and CountedContactMesh whose scalar
// counts operations.
template <class Mesh>
class SurfaceWalkOf {
 public:
  using S = typename Mesh::Scalar;
  using V = Vec3Of<S>;
  enum class On : std::uint8_t { nothing, face, edge, vertex };

  explicit SurfaceWalkOf(const Mesh& mesh, const ConeFriction& friction = {}) : mesh_(&mesh), friction_(friction) {}

  // The first position of a run, free of the surface.
  void start_free(const V& p) noexcept;
  // The first position of a run inside the object: the god-object starts where the surface is closest, which is the
  // given triangle, or its edge or corner with index `local`.
  bool start_on(std::int32_t triangle, surface::Feature feature, std::size_t local, const V& p) noexcept;
  // Goes on from g on that triangle, sliding or held.
  void resume(const V& g, std::int32_t triangle, bool sliding = false) noexcept;
  // Moves the god-object for a new position of the tip. False where it came upon a triangle that cannot be walked on
  // (Facet::regular): it is at position() on triangle(), and push() is not known. flew() says whether it came there
  // through free space, from took_off().
  bool follow(const V& p) noexcept;
  [[nodiscard]] bool flew() const noexcept { return flew_; }
  [[nodiscard]] const V& took_off() const noexcept { return took_off_; }

  [[nodiscard]] On on() const noexcept { return on_; }
  [[nodiscard]] bool touching() const noexcept { return on_ != On::nothing; }
  // The god-object, and from the tip to it (zero when free; computed without cancellation).
  [[nodiscard]] const V& position() const noexcept { return g_; }
  [[nodiscard]] const V& push() const noexcept { return push_; }
  // Of the contact: on a face its normal, else the direction of push() without friction's part; zero when free.
  [[nodiscard]] V normal() const noexcept;
  // Whether friction let the god-object go in the last step.
  [[nodiscard]] bool sliding() const noexcept { return sliding_; }
  // The triangle touched (one of them at edges and vertices) and which of its edges or corners.
  [[nodiscard]] std::int32_t triangle() const noexcept { return triangle_; }
  [[nodiscard]] std::size_t local() const noexcept { return local_; }
  // Moves between features since the start, for tests and statistics.
  [[nodiscard]] std::uint64_t transitions() const noexcept { return transitions_; }

 private:
  static constexpr S zero{0.0};
  static constexpr S one{1.0};

  bool descend(const V& p) noexcept;
  // Whether the cone holds the god-object that far from the foot point at that depth; else it slides, and the answer of
  // slip() is how far it may stay behind.
  [[nodiscard]] bool held(S away_m, S depth_m) const noexcept { return away_m <= hold_ * depth_m + rounding_; }
  S slip(S depth_m) noexcept;
  // Each returns true when the god-object has come to rest.
  bool slide_on_face(const V& p) noexcept;
  bool slide_on_edge(const V& p) noexcept;
  bool turn_at_vertex(const V& p) noexcept;
  bool leave(const V& p) noexcept;

  [[nodiscard]] bool touches(std::int32_t triangle) const noexcept;
  [[nodiscard]] bool near_rim() const noexcept;
  bool to_face(std::int32_t triangle) noexcept;
  bool to_vertex(std::int32_t triangle, std::size_t corner) noexcept;
  bool rest(const V& g, const V& push) noexcept;

  const Mesh* mesh_;
  V g_ = V::Zero();
  V push_ = V::Zero();
  V took_off_ = V::Zero();  // where stopped_
  std::int32_t triangle_ = -1;
  std::size_t local_ = 0;
  On on_ = On::nothing;
  bool stopped_ = false;  // on a triangle that is not regular
  bool flew_ = false;     // where stopped_
  bool sliding_ = false;
  ConeFriction friction_;
  S hold_ = S(0.0);      // the coefficient that holds the god-object now; 0: no friction
  S rounding_ = S(0.0);  // of the distances that friction compares
  std::uint64_t transitions_ = 0;
};

using SurfaceWalk = SurfaceWalkOf<ContactMesh>;

}  // namespace touchstone::renderers
