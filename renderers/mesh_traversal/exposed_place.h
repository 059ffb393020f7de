// Where a run starts that begins inside: the closest place of the surface that is reached from outside.
//
// Where bodies touch or overlap, the closest triangle may lie inside another body: a proxy that started there would
// stay inside. How often the surface winds around a point decides: the number of triangles that a ray from it to the
// outside leaves, less those that it enters (S. D. Roth, "Ray casting for modeling solids", Computer Graphics and Image
// Processing 18, 1982, section 3: a union is where one of the bodies is; counted, because doubled triangles and bodies
// within each other must not cancel).
#pragma once

#include "harness/surface/surface.h"
#include "renderers/mesh_traversal/contact_mesh.h"
#include "renderers/mesh_traversal/posed_bodies.h"

namespace touchstone::renderers {

// Where a run starts: inside a closed body (or behind an open sheet, its rim aside) at the closest surface point.
struct StartPlace {
  bool inside = false;
  std::int32_t triangle = -1;
  surface::Feature feature = surface::Feature::face;
  std::size_t index = 0;  // of the edge or corner
  Vec3 p_W_m = Vec3::Zero();
};
StartPlace start_place(const ContactMesh& mesh, const surface::Surface& surface, const Vec3& p) noexcept;
// Among the bodies of a scene.
StartPlace start_place(const PosedBodies& bodies, const Vec3& p) noexcept;

// How often closed bodies wind around p: 1 inside one, 2 where two overlap, 0 outside, -1 in one that is inside out.
// `Mesh`: ContactMesh or PosedBodies.
template <class Mesh>
int winding_about(const Mesh& mesh, const Vec3& p) noexcept;

}  // namespace touchstone::renderers
