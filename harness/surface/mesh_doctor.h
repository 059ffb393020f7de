// What is wrong with a mesh, and what that does to haptic rendering. Finds, never repairs.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

enum class Severity : std::uint8_t {
  note,     // good to know
  matters,  // changes what a renderer does
};

// One place of a finding.
struct MeshPlace {
  std::vector<std::int32_t> triangles;  // indices in the file's order of faces after division into triangles, from 0
  std::vector<std::int32_t> vertices;   // indices in the file's order, from 0
  Vec3 p_W_m;
};

struct MeshFinding {
  std::string name;  // see examine_mesh()
  Severity severity;
  std::size_t count;              // how many places there are
  std::string what;               // one sentence with the figures
  std::string meaning;            // what it means for rendering
  std::vector<MeshPlace> places;  // the first largest_listed of them
};

struct MeshDiagnosis {
  std::size_t triangles = 0;
  std::size_t vertices = 0;
  std::size_t components = 0;  // connected by shared edges and vertices
  std::size_t open_edges = 0;
  std::size_t boundary_loops = 0;  // chains of open edges, closed or not
  Box3 bounds;
  double area_m2 = 0.0;
  double volume_m3 = 0.0;  // signed; meaningful for a closed mesh
  bool self_intersection_checked = false;
  std::vector<MeshFinding> findings;

  [[nodiscard]] bool sound() const noexcept;  // no finding that matters
};

struct MeshDoctorRule {
  // An open mesh is meant to be open (a sheet, a height field): open edges are then only noted.
  bool sheet = false;
  std::size_t largest_listed = 10;
};

// A triangle has no area when twice its area is at most this fraction of the square of its longest edge: its normal
// then has lost more than half of the digits of a double.
inline constexpr double degenerate_area_ratio = 1e-8;

// As self_intersections() of harness/surface/cgal; nothing when it cannot tell.
using SelfIntersectionCheck =
    std::function<std::optional<std::vector<std::array<std::int32_t, 2>>>(const TriangleMesh&)>;

// Findings in this order: open-edges, inconsistent-orientation, inward-facing, degenerate-triangles,
// duplicate-triangles, duplicate-vertices, unused-vertices, non-manifold-edges, non-manifold-vertices, folds,
// self-intersections, components, and what the reader noted (folded-polygons, joined-corners). Everything but
// duplicate-vertices is looked for after vertices with equal coordinates have been joined, as make_embree_surface()
// does.
MeshDiagnosis examine_mesh(const TriangleMesh& mesh, const MeshDoctorRule& rule,
                           const SelfIntersectionCheck& self_intersections);

// For people, and for programs (schema touchstone-mesh-diagnosis/1).
std::string diagnosis_text(const MeshDiagnosis& diagnosis, const std::string& source);
std::string diagnosis_json(const MeshDiagnosis& diagnosis, const std::string& source);

}  // namespace touchstone::surface
