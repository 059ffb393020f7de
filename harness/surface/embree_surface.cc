#include "harness/surface/embree_surface.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "harness/surface/triangle_queries.h"
#include "harness/surface/triangle_surface.h"
#include "harness/surface/triangle_tree.h"

namespace touchstone::surface {
namespace {

class EmbreeSurface final : public TriangleSurface {
 public:
  // The tree over the surface's own mesh is made beside the rest of it.
  explicit EmbreeSurface(const TriangleMesh& mesh, std::unique_ptr<const TriangleTree> tree = nullptr)
      : TriangleSurface(mesh, [&](const TriangleMesh& own) { tree = std::make_unique<const TriangleTree>(own); }),
        tree_(std::move(tree)) {}

  [[nodiscard]] const TriangleTree* tree() const noexcept override { return tree_.get(); }

  // Of equally close triangles the one with the smaller index, whatever the order of visits.
  [[nodiscard]] SurfacePoint closest(const Vec3& p_W_m) const override {
    if (!p_W_m.allFinite()) return no_point(p_W_m);
    TriangleClosest best{};
    std::int32_t nearest = -1;
    double distance_m = std::numeric_limits<double>::infinity();
    tree_->within(p_W_m, distance_m, [&](std::int32_t t) {
      const TriangleClosest here = closest_on_triangle(facet(t).corners, facet(t).normal, p_W_m);
      if (nearest >= 0 && (here.squared_distance > best.squared_distance ||
                           (here.squared_distance == best.squared_distance && t > nearest)))
        return distance_m;
      best = here;
      nearest = t;
      distance_m = std::sqrt(best.squared_distance);
      return distance_m;
    });
    return finish(p_W_m, nearest, best);
  }

  [[nodiscard]] std::optional<Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override {
    if (!a_W_m.allFinite() || !b_W_m.allFinite()) return std::nullopt;
    TriangleCrossing best{};
    std::int32_t first = -1;
    tree_->along_segment(a_W_m, b_W_m, [&](std::int32_t t) {
      const auto crossing = cross_triangle(facet(t).corners, facet(t).normal, a_W_m, b_W_m);
      const bool better = crossing && (first < 0 || crossing->fraction < best.fraction ||
                                       (crossing->fraction == best.fraction && t < first));
      if (better) {
        best = *crossing;
        first = t;
      }
      return first < 0 ? 1.0 : best.fraction;
    });
    if (first < 0) return std::nullopt;
    return finish(a_W_m, b_W_m, first, best);
  }

 private:
  std::unique_ptr<const TriangleTree> tree_;  // over mesh_, which does not move: a surface is not copied
};

}  // namespace

std::shared_ptr<Surface> make_embree_surface(const TriangleMesh& mesh) { return std::make_shared<EmbreeSurface>(mesh); }

}  // namespace touchstone::surface
