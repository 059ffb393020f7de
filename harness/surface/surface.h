// What a renderer, a metric or the out-trajectory may ask of an object's surface. Implementations: analytic shapes
// (synthetic/), Embree (fast) and CGAL (exact) over triangles. Queries are const, thread-safe and do not allocate.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "harness/base/vec.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface {

struct MeshTopology;
class TriangleTree;

// Where on a triangle a point lies.
enum class Feature : std::uint8_t { face, edge, vertex, analytic };

struct SurfacePoint {
  Vec3 p_W_m;                      // on the surface
  Vec3 n_W;                        // outward unit normal; at edges and vertices the angle-weighted pseudo-normal
                                   // (Baerentzen and Aanaes 2005), whose sign decides inside against outside
  double distance_m = 0.0;         // to the query point, >= 0
  double signed_distance_m = 0.0;  // negative inside
  std::int32_t triangle = -1;      // -1 on analytic surfaces
  Feature feature = Feature::analytic;
};

struct Crossing {
  double fraction = 0.0;  // along the segment, 0 at its start, 1 at its end
  Vec3 p_W_m;
  Vec3 n_W;                    // of the triangle or shape, outward
  bool entering = false;       // from the outside to the inside
  std::int32_t triangle = -1;  // -1 on analytic surfaces
};

class Surface {
 public:
  virtual ~Surface() = default;

  // The closest surface point to p. Always exists.
  [[nodiscard]] virtual SurfacePoint closest(const Vec3& p_W_m) const = 0;
  // The first crossing of the segment a-b with the surface, from either side.
  [[nodiscard]] virtual std::optional<Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const = 0;
  // Negative inside. On an open mesh the sign is that of the closest point's pseudo-normal.
  [[nodiscard]] virtual double signed_distance(const Vec3& p_W_m) const { return closest(p_W_m).signed_distance_m; }
  [[nodiscard]] virtual Box3 bounds() const = 0;
  // The triangles behind the surface; nullptr for an analytic shape.
  [[nodiscard]] virtual const TriangleMesh* mesh() const noexcept { return nullptr; }
  // Structures over mesh() that a renderer on this surface may use, too, in place of making its own; nullptr where the
  // surface has none. They live as long as the surface.
  [[nodiscard]] virtual const MeshTopology* topology() const noexcept { return nullptr; }
  [[nodiscard]] virtual const TriangleTree* tree() const noexcept { return nullptr; }
};

}  // namespace touchstone::surface
