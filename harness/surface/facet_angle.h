// How far the normals of a triangulation's facets lie from those of the smooth surface that they stand for.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

// Median over the given triangles (those that were touched; one may be given many times) of the mean angle between the
// facet's normal and the area-weighted normals at its corners, halved: the normal of the smooth surface at a random
// place of the facet is off by about half of that at the corners. The median, so that sharp edges of a body do not
// count. 0 for no triangles.
double median_facet_angle_rad(const TriangleMesh& mesh, std::span<const std::int32_t> triangles);

// The normals of the smooth surface that a triangulation stands for: of each corner the area-weighted mean of the
// facets about it that lie within 15 degrees of the facet at hand (a sharper edge is one of the body), linear in
// between (Phong, Illumination for computer generated pictures, CACM 18, 1975).
class SmoothNormals {
 public:
  static constexpr double sharp_rad = 0.2617993877991494;  // 15 degrees: from here on an edge is one of the body
  // The mesh must outlive it.
  explicit SmoothNormals(const TriangleMesh& mesh);

  // Unit length; at a point of the triangle's plane.
  [[nodiscard]] Vec3 at(std::int32_t triangle, const Vec3& p_W_m) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace touchstone::surface
