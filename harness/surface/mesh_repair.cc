#include "harness/surface/mesh_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_pieces.h"

namespace touchstone::surface {
namespace {

void turn(TriangleMesh& mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
}

void refuse_without_orientation(const TriangleMesh& mesh, const MeshPieces& pieces) {
  const auto found = std::find(pieces.orientable.begin(), pieces.orientable.end(), false);
  if (found == pieces.orientable.end()) return;
  const auto triangle =
      static_cast<std::size_t>(pieces.first[static_cast<std::size_t>(found - pieces.orientable.begin())]);
  const Vec3& p = mesh.vertices_W_m[static_cast<std::size_t>(mesh.triangles[triangle][0])];
  throw BadData(
      fmt::format("{}: the piece with triangle {}, at ({:.6g}, {:.6g}, {:.6g}) m, has no orientation: no turning of "
                  "triangles makes neighbours agree; repair the mesh, or render it two-sided",
                  mesh.source, triangle, p.x(), p.y(), p.z()));
}

}  // namespace

OrientedMesh orient(const TriangleMesh& mesh) {
  OrientedMesh out{mesh};
  // Neighbours are known where vertices with equal coordinates are one; the triangles are the same.
  TriangleMesh welded = weld_coincident_vertices(mesh);
  const MeshPieces mixed = find_pieces(welded, make_topology(welded));
  refuse_without_orientation(welded, mixed);
  std::vector<bool> turned(mesh.triangle_count(), false);
  for (const std::int32_t t : mixed.against) {
    turned[static_cast<std::size_t>(t)] = true;
    turn(welded, static_cast<std::size_t>(t));
  }
  const MeshPieces pieces = find_pieces(welded, make_topology(welded));
  const std::vector<std::int32_t> inward = inward_pieces(welded, pieces);
  for (std::size_t t = 0; t < turned.size(); ++t) {
    if (std::find(inward.begin(), inward.end(), pieces.piece[t]) != inward.end()) turned[t] = !turned[t];
    if (!turned[t]) continue;
    turn(out.mesh, t);
    ++out.turned;
  }
  out.pieces_turned = inward.size();
  return out;
}

std::string orientation_note(const OrientedMesh& repaired) {
  return fmt::format("{}: repaired: {} of {} triangles turned ({} closed {} inside out)", repaired.mesh.source,
                     repaired.turned, repaired.mesh.triangle_count(), repaired.pieces_turned,
                     repaired.pieces_turned == 1 ? "piece was" : "pieces were");
}

TriangleMesh two_sided(const TriangleMesh& mesh) {
  TriangleMesh out = mesh;
  out.triangles.reserve(2 * mesh.triangle_count());
  for (const auto& [a, b, c] : mesh.triangles) out.triangles.push_back({a, c, b});
  return out;
}

}  // namespace touchstone::surface
