#include "harness/surface/mesh_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
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

std::vector<std::int32_t> open_vertices(const TriangleMesh& mesh, const MeshTopology& topology) {
  std::vector<std::int32_t> open;
  for (std::size_t v = 0; v < mesh.vertices_W_m.size(); ++v) {
    if ((topology.vertex_flags[v] & vertex_open) != 0) open.push_back(static_cast<std::int32_t>(v));
  }
  return open;
}

// The mesh with the vertices renamed, and the first triangle that loses its area by that.
std::pair<TriangleMesh, std::optional<std::size_t>> with_renamed(TriangleMesh mesh,
                                                                 const std::vector<std::int32_t>& renamed) {
  std::optional<std::size_t> collapsed;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& triangle = mesh.triangles[t];
    const bool before = names_a_vertex_twice(triangle);
    for (std::int32_t& corner : triangle) corner = renamed[static_cast<std::size_t>(corner)];
    if (!collapsed && !before && names_a_vertex_twice(triangle)) collapsed = t;
  }
  return {std::move(mesh), collapsed};
}

void note_joined(OrientedMesh& out, const std::vector<Vec3>& vertices, const std::vector<std::int32_t>& renamed) {
  out.joined = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    const auto to = static_cast<std::size_t>(renamed[v]);
    if (to == v) continue;
    ++out.joined;
    out.widest_gap_m = std::max(out.widest_gap_m, (vertices[to] - vertices[v]).norm());
  }
}

void close_seams(OrientedMesh& out) {
  const TriangleMesh mesh = weld_coincident_vertices(out.mesh);
  const MeshTopology topology = make_topology(mesh);
  out.open_edges = topology.open_edge_count;
  if (out.open_edges == 0) return;
  const std::vector<std::int32_t> open = open_vertices(mesh, topology);
  for (const double share : {1e-6, 1e-5, 1e-4, 1e-3}) {
    const auto renamed = joined_within(mesh, open, share * mesh.bounds().diagonal().norm());
    auto [joined, collapsed] = with_renamed(mesh, renamed);
    if (collapsed) return;
    const MeshTopology after = make_topology(joined);
    if (after.open_edge_count >= out.open_edges) continue;
    if (after.non_manifold_edges.size() > topology.non_manifold_edges.size()) return;
    out.open_edges = after.open_edge_count;
    note_joined(out, mesh.vertices_W_m, renamed);
    out.mesh = std::move(joined);
    if (out.open_edges == 0) return;
  }
}

// Corners that lie on edges of other triangles.
class JunctionSearch {
 public:
  JunctionSearch(const TriangleMesh& mesh, std::vector<std::int32_t> open, double distance_m)
      : mesh_(&mesh), by_x_(std::move(open)), distance_m_(distance_m) {
    std::ranges::sort(by_x_, {}, [&](std::int32_t v) { return at(v).x(); });
  }

  // Those within the distance of the way from one vertex to the other, and farther than it from both: from the first
  // on.
  [[nodiscard]] std::vector<std::int32_t> between(std::int32_t from, std::int32_t to) const {
    const Vec3 along = (at(to) - at(from)).normalized();
    const double length_m = (at(to) - at(from)).norm();
    const auto [least, most] = std::minmax(at(from).x(), at(to).x());
    const auto x_of = [&](std::int32_t v) { return at(v).x(); };
    const auto first = std::ranges::lower_bound(by_x_, least - distance_m_, {}, x_of);
    const auto last = std::ranges::upper_bound(by_x_, most + distance_m_, {}, x_of);
    std::vector<std::pair<double, std::int32_t>> found;
    for (auto v = first; v < last; ++v) {
      const Vec3 way = at(*v) - at(from);
      const double place_m = way.dot(along);
      if (place_m > distance_m_ && place_m < length_m - distance_m_ && (way - place_m * along).norm() <= distance_m_)
        found.emplace_back(place_m, *v);
    }
    std::ranges::sort(found);
    std::vector<std::int32_t> vertices;
    for (const auto& [place_m, v] : found) vertices.push_back(v);
    return vertices;
  }
  [[nodiscard]] double off(std::int32_t v, std::int32_t from, std::int32_t to) const {
    const Vec3 along = (at(to) - at(from)).normalized();
    return (at(v) - at(from)).cross(along).norm();
  }

 private:
  [[nodiscard]] const Vec3& at(std::int32_t v) const { return mesh_->vertices_W_m[static_cast<std::size_t>(v)]; }
  const TriangleMesh* mesh_;
  std::vector<std::int32_t> by_x_;
  double distance_m_;
};

// Splits the one of `parts` that has the edge, at the vertices, which are in order along it.
void split_at(std::vector<std::array<std::int32_t, 3>>& parts, std::int32_t from, std::int32_t to,
              const std::vector<std::int32_t>& vertices) {
  for (auto& part : parts) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (part[e] != from || part[(e + 1) % 3] != to) continue;
      const std::int32_t apex = part[(e + 2) % 3];
      part = {from, vertices.front(), apex};
      for (std::size_t i = 0; i < vertices.size(); ++i)
        parts.push_back({vertices[i], i + 1 < vertices.size() ? vertices[i + 1] : to, apex});
      return;
    }
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

OrientedMesh weld_seams(const TriangleMesh& mesh_as_read, double distance_m) {
  if (!(distance_m > 0.0 && std::isfinite(distance_m)))
    throw UsageError(fmt::format("seams are closed within a distance above 0, not {} m", distance_m));
  OrientedMesh out{weld_coincident_vertices(mesh_as_read)};
  const MeshTopology as_read = make_topology(out.mesh);
  const auto renamed = joined_within(out.mesh, open_vertices(out.mesh, as_read), distance_m);
  note_joined(out, out.mesh.vertices_W_m, renamed);
  auto [joined, collapsed] = with_renamed(std::move(out.mesh), renamed);
  if (collapsed) {
    const Vec3& p = mesh_as_read.vertices_W_m[static_cast<std::size_t>(mesh_as_read.triangles[*collapsed][0])];
    throw BadData(
        fmt::format("{}: triangle {}, at ({:.6g}, {:.6g}, {:.6g}) m, is no larger than the {:.3g} m within which "
                    "seams are to be closed; give less",
                    joined.source, *collapsed, p.x(), p.y(), p.z(), distance_m));
  }
  const MeshTopology topology = make_topology(joined);
  const JunctionSearch junctions(joined, open_vertices(joined, topology), distance_m);
  std::vector<std::array<std::int32_t, 3>> triangles = joined.triangles;
  for (std::size_t t = 0; t < joined.triangles.size(); ++t) {
    std::vector<std::array<std::int32_t, 3>> parts{joined.triangles[t]};
    for (std::size_t e = 0; e < 3; ++e) {
      if (topology.neighbours[t][e] != open_edge) continue;
      const std::int32_t from = joined.triangles[t][e];
      const std::int32_t to = joined.triangles[t][(e + 1) % 3];
      const auto on_edge = junctions.between(from, to);
      if (on_edge.empty()) continue;
      split_at(parts, from, to, on_edge);
      for (const std::int32_t v : on_edge) out.widest_gap_m = std::max(out.widest_gap_m, junctions.off(v, from, to));
    }
    if (parts.size() == 1) continue;
    ++out.split;
    triangles[t] = parts.front();
    triangles.insert(triangles.end(), parts.begin() + 1, parts.end());
  }
  out.mesh = std::move(joined);
  out.mesh.triangles = std::move(triangles);
  out.open_edges = make_topology(out.mesh).open_edge_count;
  return out;
}

std::string repair_note(const OrientedMesh& repaired) {
  std::string note;
  if (repaired.joined > 0 || repaired.split > 0) {
    note = fmt::format(
        "{}: repaired: {} corners along open edges joined{} over gaps of up to {:.3g} m; {} open edges are left",
        repaired.mesh.source, repaired.joined,
        repaired.split > 0 ? fmt::format(", and {} triangles split at corners on their edges,", repaired.split) : "",
        repaired.widest_gap_m, repaired.open_edges);
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
