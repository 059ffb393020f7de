// A tool: a closed mesh, or a shell of points, in its own frame T (origin: the handle, see pose.h), and how its mass is
// distributed.
#pragma once

#include <optional>
#include <vector>

#include "harness/surface/triangle_mesh.h"
#include "harness/tool/pose.h"

namespace touchstone::tool {

struct MassFrame {
  double mass_kg = 0.1;
  Vec3 center_T_m = Vec3::Zero();                  // of mass
  Mat3 inertia_T_kg_m2 = Mat3::Identity() * 1e-5;  // about the centre of mass, T's axes
};

// Points on the tool's surface with the inward unit normal at each (McNeely, Puterbaugh and Troy 1999).
struct PointShell {
  std::vector<Vec3> p_T_m;
  std::vector<Vec3> inward_T;
  [[nodiscard]] std::size_t size() const noexcept { return p_T_m.size(); }
};

struct Tool {
  surface::TriangleMesh mesh_T;
  MassFrame mass;
  std::optional<PointShell> shell = {};  // the tool's own: it has no mesh then
};

// Of the solid inside a closed mesh with outward orientation, of constant density: sums over the tetrahedra between the
// origin and each triangle (Mirtich 1996 gives the integrals). Throws BadData if the mesh encloses no volume.
MassFrame solid_mass_frame(const surface::TriangleMesh& mesh_T, double density_kg_per_m3);

// Of water: between wood and plastic. For tools of which nothing is known but the shape.
inline constexpr double usual_tool_density_kg_per_m3 = 1000.0;
// The tool that fills the mesh. Throws as solid_mass_frame() does.
Tool solid_tool(const surface::TriangleMesh& mesh_T, double density_kg_per_m3 = usual_tool_density_kg_per_m3);

// A tool of points alone, of equal mass each. Throws BadData for fewer than three, or all on a line: their inertia
// would be none about it.
Tool point_tool(PointShell shell, double mass_kg);

// The mesh's vertices first, then points along edges and on faces; of the points that share a cell of a grid of
// `spacing_m` the first stays. So corners and edges are kept where the mesh is coarse, and a fine mesh is thinned. The
// normal at a vertex is its angle-weighted pseudo-normal, elsewhere the face's. The same shell for the same mesh.
// Throws UsageError where the spacing is not positive, or would make more than ten million points.
PointShell make_point_shell(const surface::TriangleMesh& mesh_T, double spacing_m);
// The tool's own shell if it has one, else as make_point_shell().
PointShell shell_of(const Tool& tool, double spacing_m);

}  // namespace touchstone::tool
