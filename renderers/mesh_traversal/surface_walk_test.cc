// The walk against the twin that tries everything.
#include "renderers/mesh_traversal/surface_walk.h"

#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/mesh_traversal/god_object_reference_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using surface::TriangleMesh;

namespace {

TriangleMesh shape(const std::string& name, const synthetic::ParameterOverrides& overrides, std::size_t triangles) {
  return synthetic::make_mesh(name, overrides, triangles).mesh;
}

struct Case {
  std::string name;
  TriangleMesh mesh;
};

std::vector<Case> cases() {
  return {{"cube", testing::cube(0.02)},
          {"torus", testing::torus(0.03, 0.012, 20, 12)},
          {"bumpy", shape("bumpy", {}, 300)},
          {"duck", shape("duck", {}, 400)},
          {"v-groove", shape("v-groove", {}, 40)},
          {"extrusion", shape("extrusion", {}, 60)},
          {"step", shape("step", {}, 60)},
          {"bowl", shape("bowl", {{"thickness_m", 2e-3}}, 300)},
          {"thin-shell", shape("thin-shell", {{"thickness_m", 5e-5}}, 30)},
          {"crease", shape("crease", {{"bend_rad", -1e-6}}, 60)},
          {"gauss", shape("gauss", {}, 300)}};
}

// A tip that wanders about the body: smooth strokes, sudden turns, and jumps that go through it.
class Wander {
 public:
  Wander(std::uint64_t seed, const Box3& box) : random_(seed), box_(box) {
    p_ = anywhere(1.4);
    target_ = anywhere(0.9);
  }
  Vec3 next() {
    const double size = box_.sizes().norm();
    if (random_.uniform() < 0.02) target_ = anywhere(0.9);
    if (random_.uniform() < 0.01) return p_ = anywhere(1.3);
    p_ += 0.03 * (target_ - p_) + 0.002 * size * random_.normal() * random_.direction();
    return p_;
  }

 private:
  Vec3 anywhere(double stretch) {
    const Vec3 half = 0.5 * stretch * box_.sizes() + Vec3::Constant(0.05 * box_.sizes().maxCoeff());
    return box_.center() +
           Vec3(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)).cwiseProduct(half);
  }
  Random random_;
  Box3 box_;
  Vec3 p_, target_;
};

TEST(SurfaceWalk, IsToTheBitWhatTryingEverythingGives) {
  constexpr std::uint64_t seed = 20060;
  std::size_t touched = 0;
  for (const auto& [name, mesh] : cases()) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const TriangleMesh world =
          surface::moved(mesh, Quat(0.83, 0.31, -0.41, 0.22).normalized(), scale * Vec3(0.01, -0.02, 0.005), scale);
      const auto surface = make_embree_surface(world);
      const ContactMesh contact(*surface);
      SurfaceWalk walk(contact);
      GodObjectReference twin(*surface->mesh());
      Wander wander(seed, surface->bounds());
      Vec3 p = wander.next();
      while (surface->signed_distance(p) < 0.0) p = wander.next();
      walk.start_free(p);
      twin.start(p);
      for (int step = 0; step < 300; ++step) {
        p = wander.next();
        ASSERT_TRUE(walk.follow(p)) << name << ": the mesh must be regular";
        const Vec3& expected = twin.follow(p);
        ASSERT_EQ(walk.position(), expected)
            << name << " x " << scale << ", seed " << seed << ", step " << step << ", off by "
            << (walk.position() - expected).norm() / surface->bounds().sizes().norm() << " sizes";
        ASSERT_EQ(walk.touching(), twin.touching()) << name << " step " << step;
        ASSERT_FALSE(twin.failed()) << name;
        ASSERT_FALSE(twin.crossed()) << name << ": the walk passed through another triangle at step " << step;
        touched += walk.touching() ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(touched, 3000U) << "the test must spend time in contact";
}

}  // namespace
}  // namespace touchstone::renderers
