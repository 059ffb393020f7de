#include "renderers/mesh_traversal/exposed_place.h"

#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/surface/box_mesh.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::renderers {
using surface::TriangleMesh;

namespace {

// Boxes that overlap, nest and stand apart, with one that is inside out: how often they wind around a point is counted
// by comparing coordinates.
struct Boxes {
  std::vector<Box3> boxes;
  std::vector<int> winds;  // 1, or -1 inside out
  [[nodiscard]] int around(const Vec3& p) const {
    int winding = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) winding += boxes[i].contains(p) ? winds[i] : 0;
    return winding;
  }
  [[nodiscard]] TriangleMesh mesh() const {
    TriangleMesh all;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const TriangleMesh one = surface::box_mesh(boxes[i].min(), boxes[i].max());
      const auto first = static_cast<std::int32_t>(all.vertices_W_m.size());
      all.vertices_W_m.insert(all.vertices_W_m.end(), one.vertices_W_m.begin(), one.vertices_W_m.end());
      for (auto corners : one.triangles) {
        if (winds[i] < 0) std::swap(corners[1], corners[2]);
        all.triangles.push_back({first + corners[0], first + corners[1], first + corners[2]});
      }
    }
    return all;
  }
};

Boxes boxes(double scale, const Vec3& at) {
  const auto box = [&](const Vec3& low, const Vec3& high) { return Box3(at + scale * low, at + scale * high); };
  return {{box({-1, -1, -1}, {1, 1, 1}), box({0.5, -0.7, -0.9}, {2.5, 0.8, 0.6}),
           box({-0.4, -0.3, -0.2}, {0.1, 0.2, 0.3}), box({-2.5, 1.2, -1}, {-1.5, 2.5, 0.5})},
          {1, 1, 1, -1}};
}

TEST(WindingAbout, CountsTheBodiesAroundAPointAtEveryScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double away : {0.0, 20.0}) {
      const Boxes bodies = boxes(scale, away * scale * Vec3(1, -2, 3));
      const auto surface = surface::make_embree_surface(bodies.mesh());
      const ContactMesh mesh(*surface);
      Random random(21);
      int counted[4] = {};
      for (int i = 0; i < 20000; ++i) {
        // A tenth of them in the empty space far around.
        const double reach = (i % 10 == 0 ? 50.0 : 3.0) * scale;
        const Vec3 p = bodies.boxes.front().center() +
                       reach * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const int expected = bodies.around(p);
        ASSERT_EQ(winding_about(mesh, p), expected) << scale << " " << away << " at " << p.transpose();
        ++counted[expected + 1];
      }
      for (const int count : counted) EXPECT_GT(count, 0) << "every number must occur";
    }
  }
}

// From p the ray goes to beyond everything; where p lies before or behind the bodies along it, its end is easiest to
// misplace.
TEST(WindingAbout, ReachesBeyondTheBodiesFromAnyDistance) {
  const Boxes bodies = boxes(1.0, Vec3::Zero());
  const auto surface = surface::make_embree_surface(bodies.mesh());
  const ContactMesh mesh(*surface);
  const Vec3 along = Vec3(0.5377, 0.7391, 0.4057).normalized();
  for (int i = -2000; i <= 2000; ++i) {
    const Vec3 p = 0.01 * (i + 0.37) * along;
    ASSERT_EQ(winding_about(mesh, p), bodies.around(p)) << p.transpose();
  }
}

}  // namespace
}  // namespace touchstone::renderers
