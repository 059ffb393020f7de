#include "harness/surface/mesh_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_pieces.h"
#include "harness/surface/mesh_topology.h"

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

bool names_a_vertex_twice(const std::array<std::int32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// Which vertex each of `open` becomes if those within `distance_m` are one.
std::vector<std::int32_t> joined_within(const TriangleMesh& mesh, const std::vector<std::int32_t>& open,
                                        double distance_m) {
  TriangleMesh corners;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    corners.vertices_W_m.push_back(mesh.vertices_W_m[static_cast<std::size_t>(open[i])]);
    corners.triangles.push_back({index, index, index});
  }
  const TriangleMesh welded = weld_close_vertices(corners, distance_m);
  // The first of those that are one stands for all.
  std::vector<std::int32_t> first(welded.vertices_W_m.size(), -1), renamed(mesh.vertices_W_m.size());
  std::iota(renamed.begin(), renamed.end(), 0);
  for (std::size_t i = 0; i < open.size(); ++i) {
    auto& kept = first[static_cast<std::size_t>(welded.triangles[i][0])];
    if (kept < 0) kept = open[i];
    renamed[static_cast<std::size_t>(open[i])] = kept;
  }
  return renamed;
}

void close_seams(OrientedMesh& out) {
  const TriangleMesh mesh = weld_coincident_vertices(out.mesh);
  const MeshTopology topology = make_topology(mesh);
  out.open_edges = topology.open_edge_count;
  if (out.open_edges == 0) return;
  std::vector<std::int32_t> open;
  for (std::size_t v = 0; v < mesh.vertices_W_m.size(); ++v) {
    if ((topology.vertex_flags[v] & vertex_open) != 0) open.push_back(static_cast<std::int32_t>(v));
  }
  for (const double share : {1e-6, 1e-5, 1e-4, 1e-3}) {
    const auto renamed = joined_within(mesh, open, share * mesh.bounds().diagonal().norm());
    TriangleMesh joined = mesh;
    bool collapsed = false;
    for (auto& triangle : joined.triangles) {
      const bool before = names_a_vertex_twice(triangle);
      for (std::int32_t& corner : triangle) corner = renamed[static_cast<std::size_t>(corner)];
      collapsed = collapsed || (!before && names_a_vertex_twice(triangle));
    }
    if (collapsed) return;
    const MeshTopology after = make_topology(joined);
    if (after.open_edge_count >= out.open_edges) continue;
    if (after.non_manifold_edges.size() > topology.non_manifold_edges.size()) return;
    out.open_edges = after.open_edge_count;
    out.joined = 0;
    for (const std::int32_t v : open) {
      const std::int32_t to = renamed[static_cast<std::size_t>(v)];
      if (to == v) continue;
      ++out.joined;
      const auto& vertices = mesh.vertices_W_m;
      const double gap_m = (vertices[static_cast<std::size_t>(to)] - vertices[static_cast<std::size_t>(v)]).norm();
      out.widest_gap_m = std::max(out.widest_gap_m, gap_m);
    }
    out.mesh = std::move(joined);
    if (out.open_edges == 0) return;
  }
}

}  // namespace

OrientedMesh orient(const TriangleMesh& mesh_as_read) {
  OrientedMesh out{mesh_as_read};
  close_seams(out);
  const TriangleMesh mesh = out.mesh;
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

std::string repair_note(const OrientedMesh& repaired) {
  std::string note;
  if (repaired.joined > 0) {
    note = fmt::format(
        "{}: repaired: {} corners along open edges joined over gaps of up to {:.3g} m; {} open edges are "
        "left",
        repaired.mesh.source, repaired.joined, repaired.widest_gap_m, repaired.open_edges);
  }
  if (repaired.turned > 0) {
    note += fmt::format("{}{}: repaired: {} of {} triangles turned ({} closed {} inside out)", note.empty() ? "" : "\n",
                        repaired.mesh.source, repaired.turned, repaired.mesh.triangle_count(), repaired.pieces_turned,
                        repaired.pieces_turned == 1 ? "piece was" : "pieces were");
  }
  return note;
}

TriangleMesh two_sided(const TriangleMesh& mesh) {
  TriangleMesh out = mesh;
  out.triangles.reserve(2 * mesh.triangle_count());
  for (const auto& [a, b, c] : mesh.triangles) out.triangles.push_back({a, c, b});
  return out;
}

}  // namespace touchstone::surface
