#include "harness/surface/mesh_pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::surface {
namespace {

bool runs_along(const std::array<std::int32_t, 3>& corners, std::int32_t from, std::int32_t to) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (corners[i] == from && corners[(i + 1) % 3] == to) return true;
  }
  return false;
}

// Triangles on the other side of edge e: the one neighbour, or for an edge where orientations clash or more than two
// triangles meet, all the others that have it.
void across(const TriangleMesh& mesh, const MeshTopology& topology, std::size_t t, std::size_t e,
            std::vector<std::int32_t>& out) {
  out.clear();
  const std::int32_t neighbour = topology.neighbours[t][e];
  if (neighbour >= 0) out.push_back(neighbour);
  if (neighbour != non_manifold_edge) return;
  const std::int32_t from = mesh.triangles[t][e];
  const std::int32_t to = mesh.triangles[t][(e + 1) % 3];
  for (const std::int32_t other : topology.fan(at(from))) {
    const auto& corners = mesh.triangles[at(other)];
    if (other != static_cast<std::int32_t>(t) && (runs_along(corners, from, to) || runs_along(corners, to, from)))
      out.push_back(other);
  }
}

}  // namespace

MeshPieces find_pieces(const TriangleMesh& mesh, const MeshTopology& topology) {
  const std::size_t n = mesh.triangles.size();
  MeshPieces pieces;
  pieces.piece.assign(n, -1);
  std::vector<signed char> side(n, 0);
  std::vector<std::int32_t> queue;
  std::vector<std::int32_t> others;
  for (std::size_t seed = 0; seed < n; ++seed) {
    if (pieces.piece[seed] >= 0) continue;
    const auto id = static_cast<std::int32_t>(pieces.first.size());
    const Vec3 origin = mesh.vertices_W_m[at(mesh.triangles[seed][0])];
    bool orientable = true;
    bool closed = true;
    double volume = 0.0;
    std::array<double, 2> area{};  // of either orientation
    queue.assign(1, static_cast<std::int32_t>(seed));
    pieces.piece[seed] = id;
    side[seed] = 1;
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const std::size_t t = at(queue[head]);
      const auto& c = mesh.triangles[t];
      area[side[t] > 0 ? 0 : 1] += mesh.scaled_normal(t).norm();
      volume += (mesh.vertices_W_m[at(c[0])] - origin)
                    .dot((mesh.vertices_W_m[at(c[1])] - origin).cross(mesh.vertices_W_m[at(c[2])] - origin)) /
                6.0;
      for (std::size_t e = 0; e < 3; ++e) {
        across(mesh, topology, t, e, others);
        // Across an edge of three or more triangles no orientation is the right one.
        const bool two_sided = others.size() == 1;
        closed = closed && two_sided;
        for (const std::int32_t other : others) {
          const bool agrees = runs_along(mesh.triangles[at(other)], c[(e + 1) % 3], c[e]);
          const auto wanted = static_cast<signed char>(agrees ? side[t] : -side[t]);
          if (pieces.piece[at(other)] < 0) {
            pieces.piece[at(other)] = id;
            side[at(other)] = two_sided ? wanted : side[t];
            queue.push_back(other);
          } else if (two_sided && side[at(other)] != wanted) {
            orientable = false;
          }
        }
      }
    }
    const signed char minority = area[1] <= area[0] ? -1 : 1;
    for (const std::int32_t t : queue) {
      if (side[at(t)] == minority) pieces.against.push_back(t);
    }
    pieces.first.push_back(static_cast<std::int32_t>(seed));
    pieces.orientable.push_back(orientable);
    pieces.closed.push_back(closed);
    pieces.volume_m3.push_back(volume);
  }
  std::sort(pieces.against.begin(), pieces.against.end());
  return pieces;
}

std::vector<std::int32_t> inward_pieces(const TriangleMesh& mesh, const MeshPieces& pieces) {
  std::vector<std::int32_t> inward;
  for (std::size_t i = 0; i < pieces.count(); ++i) {
    if (!pieces.closed[i] || !pieces.orientable[i] || !(pieces.volume_m3[i] < 0.0)) continue;
    // A hollow: an inward piece within an outward one is right.
    if (pieces.count() > 1 && pieces.count() <= most_nested_pieces) {
      Vec3 p = Vec3::Zero();
      for (const std::int32_t v : mesh.triangles[at(pieces.first[i])]) p += mesh.vertices_W_m[at(v)] / 3.0;
      double winding = 0.0;
      for (std::size_t j = 0; j < pieces.count(); ++j) {
        if (j != i && pieces.closed[j]) winding += winding_number(mesh, pieces, static_cast<std::int32_t>(j), p);
      }
      if (winding > 0.5) continue;
    }
    inward.push_back(static_cast<std::int32_t>(i));
  }
  return inward;
}

double winding_number(const TriangleMesh& mesh, const MeshPieces& pieces, std::int32_t piece, const Vec3& p) {
  double angle = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (pieces.piece[t] != piece) continue;
    const auto& c = mesh.triangles[t];
    const Vec3 u = mesh.vertices_W_m[at(c[0])] - p;
    const Vec3 v = mesh.vertices_W_m[at(c[1])] - p;
    const Vec3 w = mesh.vertices_W_m[at(c[2])] - p;
    const double lu = u.norm();
    const double lv = v.norm();
    const double lw = w.norm();
    angle += 2.0 * std::atan2(u.dot(v.cross(w)), lu * lv * lw + u.dot(v) * lw + v.dot(w) * lu + w.dot(u) * lv);
  }
  return angle / (4.0 * std::numbers::pi);
}

}  // namespace touchstone::surface
