// Which triangle lies beside which: compact arrays for a renderer that walks on the surface, and the normals that
// decide inside against outside. Built in O(n) without sorting.
//
// Edge e of a triangle (e = 0, 1, 2) runs from its corner e to its corner (e + 1) mod 3.
// Pseudo-normals: J. A. Baerentzen and H. Aanaes, "Signed distance computation using the angle weighted pseudonormal",
// IEEE TVCG 11(3), 2005: a vertex's is the sum of the incident faces' unit normals weighted by their angle at the
// vertex (their equation 3), an edge's the sum of its two faces' unit normals (equation 4). On a closed, consistently
// oriented mesh the sign of (q - p) . n at the closest point p is that of the distance of q (their theorem 1).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

// Instead of a neighbour.
inline constexpr std::int32_t open_edge = -1;  // no other triangle has this edge
inline constexpr std::int32_t non_manifold_edge =
    -2;  // more than two triangles have it, or two that disagree in orientation

// +1: ridge, -1: valley, 0: flat within rounding, or no neighbour.
enum class Convexity : std::int8_t { valley = -1, flat = 0, ridge = 1 };

struct MeshTopology {
  // Per triangle.
  std::vector<std::array<std::int32_t, 3>> neighbours;  // across edge e: a triangle, open_edge or non_manifold_edge
  std::vector<std::array<Convexity, 3>> convexity;      // of edge e
  std::vector<Vec3> face_normals;                       // unit, outward; zero where the triangle has no area

  // Per vertex.
  std::vector<Vec3> vertex_normals;         // angle-weighted pseudo-normal, unit; zero at unused vertices
  std::vector<std::uint8_t> vertex_flags;   // of VertexFlag
  std::vector<std::int32_t> fan_start;      // size: vertices + 1
  std::vector<std::int32_t> fan_triangles;  // incident triangles, see fan()

  // What a renderer may want to refuse. Each edge once, as (smaller, larger) vertex index.
  std::vector<std::array<std::int32_t, 2>> non_manifold_edges;  // three or more triangles
  std::vector<std::array<std::int32_t, 2>> disoriented_edges;   // two triangles that run along it the same way
  std::size_t open_edge_count = 0;

  // Triangles at the vertex, counter-clockwise seen from outside; at an open vertex the first has an open (or
  // non-manifold) edge clockwise of it. At a vertex where several fans meet they follow one another.
  [[nodiscard]] std::span<const std::int32_t> fan(std::size_t vertex) const {
    const auto first = static_cast<std::size_t>(fan_start[vertex]);
    return {fan_triangles.data() + first, static_cast<std::size_t>(fan_start[vertex + 1]) - first};
  }
  // The edge's pseudo-normal, unit: of both triangles, or of the one where there is no (single) neighbour.
  [[nodiscard]] Vec3 edge_normal(std::size_t triangle, std::size_t edge) const;
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return neighbours.capacity() * sizeof(neighbours[0]) + convexity.capacity() * sizeof(convexity[0]) +
           (face_normals.capacity() + vertex_normals.capacity()) * sizeof(Vec3) + vertex_flags.capacity() +
           (fan_start.capacity() + fan_triangles.capacity()) * sizeof(std::int32_t);
  }
  // Every edge has exactly two triangles that agree in orientation: inside and outside exist.
  [[nodiscard]] bool closed() const noexcept {
    return open_edge_count == 0 && non_manifold_edges.empty() && disoriented_edges.empty();
  }
};

enum VertexFlag : std::uint8_t {
  vertex_used = 1,
  vertex_open = 2,          // at an open edge
  vertex_non_manifold = 4,  // several fans meet, or a non-manifold edge ends here
};

// Triangles that name a vertex twice are left out: no neighbours, in no fan.
// Vertices are told apart by index: weld_coincident_vertices() first where a file repeats them.
MeshTopology make_topology(const TriangleMesh& mesh);

}  // namespace touchstone::surface
