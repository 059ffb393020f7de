// The jump between two planes against its closed form, and what a step over it costs.
#include "renderers/friction/contact_transition.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "harness/surface/embree_surface.h"
#include "renderers/mesh_traversal/contact_mesh.h"
#include "renderers/proxy/ball_proxy.h"

namespace touchstone::renderers {
namespace {

// Two planes through the y axis: the level one, and one that rises by `bend` over x > 0.
struct Crease {
  explicit Crease(double bend) : normals{Vec3(0, 0, 1), Vec3(-std::sin(bend), 0, std::cos(bend))} {}
  // Where a point rests that is sent to q: on the level plane over x < 0, else in the crease.
  [[nodiscard]] SlidePlaceOf<double> at(double share, const Vec3& q) const {
    const bool level = q.x() < 0.0;
    SlidePlaceOf<double> place{share, Vec3(level ? q.x() : 0.0, q.y(), 0.0), {}};
    place.contact.n = {normals[0], normals[1], Vec3::Zero()};
    place.contact.size = level ? 1 : 2;
    return place;
  }
  std::array<Vec3, 2> normals;
};

// A tip 1 mm deep and 0.2 mm beyond the crease pulls from 0.6 mm before it: the place of rest leaves the level plane at
// the share with x = 0.
TEST(SlideJump, IsWhereTheLinesOfRestMeet) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Crease crease(0.3);
    const Vec3 p = scale * Vec3(0.2e-3, 0.1e-3, -1e-3);
    const Vec3 slide = scale * Vec3(0.8e-3, 0.3e-3, 0.0);
    const auto place = [&](double share) { return crease.at(share, p - share * slide); };
    const JumpOf<double> jump = jump_between<double>(place(0.1), place(0.9), slide, p, 0.15, 1e-18 * scale);
    EXPECT_NEAR(jump.share, 0.25, 1e-12) << scale;
    EXPECT_LT((jump.position - scale * Vec3(0, 0.025e-3, 0)).norm(), 1e-15 * scale) << scale;
  }
}

TEST(SlideJump, IsNoneWhereOneSideReachesTheCone) {
  const Crease crease(0.3);
  const Vec3 p(0.2e-3, 0.1e-3, -1e-3);
  const Vec3 slide(0.8e-3, 0.3e-3, 0.0);
  const auto place = [&](double share) { return crease.at(share, p - share * slide); };
  // With so much friction the tip is on the cone while the place of rest is still on the level plane.
  EXPECT_LT(jump_between<double>(place(0.1), place(0.9), slide, p, 0.25, 1e-18).share, 0.0);
  // The same contacts on both sides: no lines that meet.
  EXPECT_LT(jump_between<double>(place(0.5), place(0.9), slide, p, 0.15, 1e-18).share, 0.0);
}

// Every step of a ball that is dragged to and fro over creases: halving took 17 searches for the steps that jump.
TEST(SlideJump, TakesFewSearches) {
  for (const double bend : {1e-4, 1e-3, 1e-2, 5e-2}) {
    for (const double scale : {1e-3, 1.0, 1e2}) {
      const double far = 0.02 * std::cos(bend);
      const double height = 0.02 * std::sin(bend);
      surface::TriangleMesh mesh;
      for (const Vec3& v : {Vec3(-0.02, -0.02, 0), Vec3(-0.02, 0.02, 0), Vec3(0, -0.02, 0), Vec3(0, 0.02, 0),
                            Vec3(far, -0.02, height), Vec3(far, 0.02, height)})
        mesh.vertices_W_m.push_back(scale * v);
      mesh.triangles = {{0, 2, 1}, {2, 3, 1}, {2, 4, 3}, {4, 5, 3}};
      const auto surface = make_embree_surface(mesh);
      const auto contact = contact_mesh(surface);
      BallProxy ball(*contact, *surface, scale * 1e-3, ConeFriction{0.3, 0.3});
      ball.start(scale * Vec3(-2e-3, 0, 2e-3));
      ball.follow(scale * Vec3(-2e-3, 0, 0.5e-3));
      std::uint64_t most = 0;
      std::uint64_t before = ball.moves();
      for (int i = 0; i < 800; ++i) {
        ball.follow(scale * Vec3(2e-3 * std::sin(0.02 * i - 0.5 * std::numbers::pi), 1e-3 * std::sin(0.007 * i),
                                 1e-4 * std::sin(0.05 * i)));
        if (ball.touching()) most = std::max(most, ball.moves() - before);
        before = ball.moves();
      }
      EXPECT_LE(most, 10U) << "bend " << bend << ", scale " << scale;
      EXPECT_GE(most, 2U) << "bend " << bend << ", scale " << scale;
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
