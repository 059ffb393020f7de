#include "harness/tool/tool.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "harness/base/error.h"
#include "harness/surface/mesh_topology.h"

namespace touchstone::tool {
using surface::TriangleMesh;

MassFrame solid_mass_frame(const TriangleMesh& mesh_T, double density_kg_per_m3) {
  // From the centre of the bounds: less cancellation where the tool is far from its handle.
  const Vec3 origin = mesh_T.bounds().center();
  double volume = 0.0;
  Vec3 first = Vec3::Zero();   // integral of x
  Mat3 second = Mat3::Zero();  // integral of x x^T
  for (const auto& [ia, ib, ic] : mesh_T.triangles) {
    const Vec3 a = mesh_T.vertices_W_m[surface::at(ia)] - origin;
    const Vec3 b = mesh_T.vertices_W_m[surface::at(ib)] - origin;
    const Vec3 c = mesh_T.vertices_W_m[surface::at(ic)] - origin;
    // The signed tetrahedra from the origin to each triangle add up to the body, whatever the origin (the divergence
    // theorem): volume V = a . (b x c) / 6, integral of x over it V / 4 (a + b + c).
    const double v = a.dot(b.cross(c)) / 6.0;
    const Vec3 s = a + b + c;
    volume += v;
    first += v / 4.0 * s;
    // Over a tetrahedron with one corner at 0: V / 20 (sum of x_i x_i^T + s s^T).
    second += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  const double size = mesh_T.bounds().diagonal().norm();
  if (!(volume > 1e-9 * size * size * size)) {
    throw BadData(
        fmt::format("{}: the tool's mesh encloses {:.3g} m^3; a closed mesh with outward orientation was "
                    "expected: see `touchstone doctor`",
                    mesh_T.source, volume));
  }
  MassFrame frame;
  frame.mass_kg = density_kg_per_m3 * volume;
  const Vec3 center = first / volume;
  frame.center_T_m = origin + center;
  // C = integral of x x^T about the centre (Steiner's shift takes V c c^T off); the inertia is tr(C) 1 - C.
  const Mat3 about_center = density_kg_per_m3 * (second - volume * center * center.transpose());
  frame.inertia_T_kg_m2 = about_center.trace() * Mat3::Identity() - about_center;
  return frame;
}

Tool solid_tool(const TriangleMesh& mesh_T, double density_kg_per_m3) {
  return {mesh_T, solid_mass_frame(mesh_T, density_kg_per_m3)};
}

Tool point_tool(PointShell shell, double mass_kg) {
  if (!(mass_kg > 0.0)) throw UsageError(fmt::format("mass of the tool: {} kg; more than 0 was expected", mass_kg));
  const double each = mass_kg / double(shell.size());
  Tool tool;
  tool.mass.mass_kg = mass_kg;
  tool.mass.center_T_m = Vec3::Zero();
  for (const Vec3& p : shell.p_T_m) tool.mass.center_T_m += p / double(shell.size());
  Mat3 second = Mat3::Zero();
  for (const Vec3& p : shell.p_T_m) {
    const Vec3 r = p - tool.mass.center_T_m;
    second += each * r * r.transpose();
  }
  tool.mass.inertia_T_kg_m2 = second.trace() * Mat3::Identity() - second;
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(tool.mass.inertia_T_kg_m2).eigenvalues();
  constexpr double small = 1e-9;
  if (shell.size() < 3 || !(principal[0] > small * principal[2])) {
    throw BadData(
        fmt::format("a tool of {} points: at least three that do not lie on a line were expected", shell.size()));
  }
  tool.shell = std::move(shell);
  return tool;
}

PointShell shell_of(const Tool& tool, double spacing_m) {
  return tool.shell ? *tool.shell : make_point_shell(tool.mesh_T, spacing_m);
}

PointShell make_point_shell(const TriangleMesh& mesh_T, double spacing_m) {
  constexpr double most_points = 1e7;
  if (!(spacing_m > 0.0))
    throw UsageError(fmt::format("spacing of the point shell: {} m; more than 0 was expected", spacing_m));
  // A shell has about a point for each spacing squared.
  double area = 0.0;
  for (std::size_t t = 0; t < mesh_T.triangle_count(); ++t) area += 0.5 * mesh_T.scaled_normal(t).norm();
  if (area / (spacing_m * spacing_m) > most_points) {
    throw UsageError(
        fmt::format("spacing of the point shell: {} m makes more than ten million points on {}; give a "
                    "larger one",
                    spacing_m, mesh_T.source));
  }
  const surface::MeshTopology topology = make_topology(mesh_T);
  const Vec3 low = mesh_T.bounds().min();
  std::set<std::array<std::int64_t, 3>> taken;
  PointShell shell;
  const auto add = [&](const Vec3& p, const Vec3& outward) {
    // Cells are shifted by half of one, so that flat sides of a body do not lie between two of them.
    const Vec3 cell = ((p - low) / spacing_m).array() + 0.5;
    const std::array<std::int64_t, 3> key{static_cast<std::int64_t>(std::floor(cell.x())),
                                          static_cast<std::int64_t>(std::floor(cell.y())),
                                          static_cast<std::int64_t>(std::floor(cell.z()))};
    if (!taken.insert(key).second) return;
    shell.p_T_m.push_back(p);
    shell.inward_T.push_back(-outward);
  };
  for (std::size_t v = 0; v < mesh_T.vertices_W_m.size(); ++v) {
    if ((topology.vertex_flags[v] & surface::vertex_used) != 0) add(mesh_T.vertices_W_m[v], topology.vertex_normals[v]);
  }
  const auto corner = [&](std::size_t t, std::size_t i) {
    return mesh_T.vertices_W_m[surface::at(mesh_T.triangles[t][i])];
  };
  for (std::size_t t = 0; t < mesh_T.triangle_count(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (topology.convexity[t][e] != surface::Convexity::ridge) continue;
      const Vec3 a = corner(t, e);
      const Vec3 along = corner(t, (e + 1) % 3) - a;
      const int count = static_cast<int>(std::ceil(along.norm() / spacing_m));
      for (int i = 1; i < count; ++i) add(a + along * (double(i) / count), topology.edge_normal(t, e));
    }
  }
  for (std::size_t t = 0; t < mesh_T.triangle_count(); ++t) {
    const Vec3 a = corner(t, 0);
    const Vec3 u = corner(t, 1) - a;
    const Vec3 v = corner(t, 2) - a;
    // Twice as dense as the cells, so that few of them stay empty.
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
    const int count = static_cast<int>(std::ceil(2.0 * longest / spacing_m));
    for (int i = 1; i < count; ++i)
      for (int j = 1; i + j < count; ++j)
        add(a + u * (double(i) / count) + v * (double(j) / count), topology.face_normals[t]);
  }
  return shell;
}

}  // namespace touchstone::tool
