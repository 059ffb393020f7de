#include "harness/surface/mesh_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/surface/mesh_doctor.h"
#include "harness/surface/mesh_pieces.h"
#include "harness/surface/mesh_topology.h"

namespace touchstone::surface {
namespace {

// The rim of a square sheet of n triangles has 4 sqrt(n / 2) edges; longer sheets have more.
bool rather_holes(std::size_t open_edges, std::size_t triangles) {
  return static_cast<double>(open_edges) < std::sqrt(static_cast<double>(triangles));
}

bool suspicious(const TriangleMesh& mesh, const MeshTopology& topology) {
  if (!topology.non_manifold_edges.empty() || !topology.disoriented_edges.empty()) return true;
  if (topology.open_edge_count > 0 && rather_holes(topology.open_edge_count, mesh.triangle_count())) return true;
  const auto flat = [](const Vec3& normal) { return normal.isZero(0.0); };
  if (std::any_of(topology.face_normals.begin(), topology.face_normals.end(), flat)) return true;
  const auto joined = [](std::uint8_t flags) { return (flags & vertex_non_manifold) != 0; };
  if (std::any_of(topology.vertex_flags.begin(), topology.vertex_flags.end(), joined)) return true;
  return !inward_pieces(mesh, find_pieces(mesh, topology)).empty();
}

std::string hint(const std::string& finding) {
  if (finding == "inconsistent-orientation" || finding == "inward-facing") return "; --repair turns them";
  return "";
}

}  // namespace

std::vector<std::string> mesh_warnings(const Surface& surface) {
  if (surface.mesh() == nullptr) return {};
  const TriangleMesh& mesh = *surface.mesh();
  std::optional<MeshTopology> own;
  if (surface.topology() == nullptr) own = make_topology(mesh);
  const MeshTopology& topology = own ? *own : *surface.topology();
  if (!suspicious(mesh, topology)) return {};
  MeshDoctorRule rule;
  rule.sheet = !rather_holes(topology.open_edge_count, mesh.triangle_count());
  rule.largest_listed = 1;
  std::vector<std::string> out;
  for (const MeshFinding& finding : examine_mesh(mesh, rule, nullptr).findings) {
    if (finding.severity != Severity::matters) continue;
    std::string place;
    if (!finding.places.empty()) {
      const MeshPlace& first = finding.places.front();
      place =
          fmt::format("; the first at ({:.6g}, {:.6g}, {:.6g}) m", first.p_W_m.x(), first.p_W_m.y(), first.p_W_m.z());
      if (!first.triangles.empty()) place += fmt::format(", triangle {}", first.triangles.front());
    }
    out.push_back(fmt::format("{}: {}: {}{}. {} (touchstone doctor lists all{})", mesh.source, finding.name,
                              finding.what, place, finding.meaning, hint(finding.name)));
  }
  return out;
}

std::vector<std::string> reading_notes(const TriangleMesh& mesh) {
  std::vector<std::string> out;
  for (const MeshReadingNote& note : mesh.notes) {
    const Vec3& p = note.first_W_m;
    out.push_back(fmt::format("{}: {}: {}; the first at ({:.6g}, {:.6g}, {:.6g}) m", mesh.source, note.name, note.what,
                              p.x(), p.y(), p.z()));
  }
  return out;
}

}  // namespace touchstone::surface
