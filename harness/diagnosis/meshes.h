// Meshes whose right answer is known exactly: bodies side by side, sheets and roofs with their top at z = 0. Closed and
// outward unless said otherwise.
#pragma once

#include "harness/base/rooms.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::diagnosis {

// Both as one mesh, side by side in the arrays and not joined.
TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b);
// [-h, h]^2 at z = 0, normal +z, open: squares about the origin whose size halves from ring to ring until the innermost
// is at most `smallest_m` wide. Every triangle is right-angled with two equal legs.
TriangleMesh nested_sheet(double h, double smallest_m);
// A block 2h wide and h deep whose top is two planes that meet at x = 0: level for x < 0, falling at `angle_rad`
// (rising if negative) for x > 0.
TriangleMesh roof(double h, double angle_rad);

}  // namespace touchstone::diagnosis
