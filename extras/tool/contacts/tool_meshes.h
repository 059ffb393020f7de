// Closed meshes with outward orientation for tools and objects of the exact cases.
#pragma once

#include <cstddef>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::contacts {

// `divisions` squares along each side of each face.
surface::TriangleMesh box_mesh(const Vec3& low_m, const Vec3& high_m, int divisions = 1);
// An icosphere with its vertices on the ellipsoid.
surface::TriangleMesh ellipsoid_mesh(const Vec3& center_m, const Vec3& semi_axes_m, std::size_t triangles);
// Along x from x_low to x_high; a prism with `sides` edges along x, its corners on the cylinder.
surface::TriangleMesh cylinder_mesh(const Vec3& center_m, double radius_m, double length_m, int sides);
// A block below z = 0 with a V-groove along x whose walls rise at `angle_rad` from a line at z = -depth.
surface::TriangleMesh groove_mesh(double depth_m, double angle_rad, double half_size_m);
// A block below z = 0 with a square through hole along z.
surface::TriangleMesh hole_mesh(double hole_half_width_m, double half_size_m, double depth_m);
// Both as one mesh, side by side.
surface::TriangleMesh joined(const surface::TriangleMesh& a, const surface::TriangleMesh& b);

}  // namespace touchstone::contacts
