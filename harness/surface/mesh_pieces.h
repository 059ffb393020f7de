// The connected pieces of a mesh: their orientation, volume and nesting. For the doctor.
#pragma once

#include <cstdint>
#include <vector>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

struct MeshPieces {
  std::vector<std::int32_t> piece;    // of each triangle: connected across edges, whatever their orientation
  std::vector<std::int32_t> against;  // triangles oriented against the majority (by area) of their piece
  std::vector<bool> orientable;       // per piece; false for a Moebius strip
  std::vector<bool> closed;           // per piece: no open and no non-manifold edge
  std::vector<double> volume_m3;      // per piece, signed, about its own first corner
  std::vector<std::int32_t> first;    // per piece, a triangle of it

  [[nodiscard]] std::size_t count() const noexcept { return first.size(); }
};

MeshPieces find_pieces(const TriangleMesh& mesh, const MeshTopology& topology);

// The closed pieces that enclose a negative volume: their normals point inwards. Not those within another piece, which
// are hollows; nesting is looked for among at most `most_nested_pieces`.
std::vector<std::int32_t> inward_pieces(const TriangleMesh& mesh, const MeshPieces& pieces);

// Looking for nesting costs the number of pieces times that of triangles.
inline constexpr std::size_t most_nested_pieces = 200;

// How often the piece winds around p: 1 inside an outward closed piece, 0 outside (sum of solid angles over 4 pi;
// A. Van Oosterom and J. Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30, 1983, equation
// 8).
double winding_number(const TriangleMesh& mesh, const MeshPieces& pieces, std::int32_t piece, const Vec3& p);

}  // namespace touchstone::surface
