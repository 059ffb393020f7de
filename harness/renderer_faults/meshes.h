// Meshes whose right answer is known exactly: bodies side by side, sheets and roofs with their top at z = 0. Closed and
// outward unless said otherwise.
#pragma once

#include "harness/surface/triangle_mesh.h"

namespace touchstone::renderer_faults {

// Both as one mesh, side by side in the arrays and not joined.
surface::TriangleMesh together(const surface::TriangleMesh& a, const surface::TriangleMesh& b);
// [-h, h]^2 at z = 0, normal +z, open: squares about the origin whose size halves from ring to ring until the innermost
// is at most `smallest_m` wide. Every triangle is right-angled with two equal legs.
surface::TriangleMesh nested_sheet(double h, double smallest_m);
// A block 2h wide and h deep whose top is two planes that meet at x = 0: level for x < 0, falling at `angle_rad`
// (rising if negative) for x > 0.
surface::TriangleMesh roof(double h, double angle_rad);

}  // namespace touchstone::renderer_faults
