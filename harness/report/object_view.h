// The object as a report draws it: fine enough to show where the error is, coarse enough for a browser. Triangles that
// are large beside the error's pattern are split where they were touched (which changes no shape); meshes of more
// triangles than a browser turns smoothly are thinned by joining vertices within cubes of a grid (Rossignac and Borrel
// 1993), which the note then says.
#pragma once

#include "harness/metrics/error_map.h"
#include "harness/report/evaluation.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::report {

inline constexpr std::size_t most_drawn_triangles = 60'000;

// `touched` is a box around the path; triangles in it are split until their edges are no longer than `detail_m`, as far
// as the limit allows.
surface::TriangleMesh drawn_mesh(const surface::TriangleMesh& mesh, const Box3& touched, double detail_m,
                                 std::size_t most_triangles = most_drawn_triangles);

// `errors` are those at points of the surface.
ObjectView object_view(const surface::TriangleMesh& mesh, const metrics::ErrorMap& errors, const Box3& touched,
                       double detail_m);

}  // namespace touchstone::report
