// The god-object of a ball tip against exact answers and against the point tip.
#include "renderers/proxy/ball_proxy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "harness/base/random.h"
#include "harness/testing/steps.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::SurfacePoint;
using surface::TriangleMesh;

namespace {

constexpr double stiffness = 500.0;
constexpr double eps = std::numeric_limits<double>::epsilon();
// Rounding of a position in a shape of 0.1 m, with the solver's own stopping rule (32 eps of the largest coordinate).
constexpr double rounding = 256.0 * eps * 0.1;

struct World {
  TriangleMesh mesh;
  Quat turn = awkward_rotation();
  Vec3 shift;
  double scale;
  std::unique_ptr<rendering::Renderer> renderer;
  Hand hand;

  World(const TriangleMesh& shape, double radius, double scale_)
      : shift(scale_ * Vec3(0.01, -0.02, 0.005)),
        scale(scale_),
        renderer(god_object(surface::moved(shape, turn, shift, scale), stiffness / scale, radius * scale)),
        hand(*renderer) {}

  struct Answer {
    Vec3 center;  // in the shape's frame and unit
    Vec3 force;
    bool contact;
    Vec3 normal;
  };
  Answer to(const Vec3& p) {
    const StepResult result = hand.to(turn * (scale * p) + shift);
    return {turn.conjugate() * (result.contact_W_m - shift) / scale, turn.conjugate() * result.f_W_N, result.contact,
            turn.conjugate() * result.n_W};
  }
  Answer stroke(const Vec3& from, const Vec3& p, int steps) {
    Answer answer{};
    for (int i = 1; i <= steps; ++i) answer = to(from + (p - from) * i / steps);
    return answer;
  }
};

TEST(BallProxy, OnAPlaneItRestsAtItsRadiusOverFacesEdgesAndVertices) {
  for (const double scale : unit_scales()) {
    for (const double radius : {1e-5, 1e-3, 2e-2}) {
      World world(testing::grid(0.05, 10), radius, scale);
      EXPECT_FALSE(world.to({0.001, 0.002, 1.01 * radius}).contact);
      Random random(11);
      Vec3 at(0.001, 0.002, 0);
      for (int i = 0; i < 300; ++i) {
        at += Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0) * random.log_uniform(1e-6, 5e-3);
        at = at.cwiseMax(-0.04).cwiseMin(0.04);
        if (i % 10 == 0) at = (at / 0.01).array().round() * 0.01;  // straight over a vertex
        const double depth = random.log_uniform(1e-7, 5e-3);
        const auto answer = world.to({at.x(), at.y(), radius - depth});
        ASSERT_TRUE(answer.contact) << i;
        ASSERT_LE((answer.center - Vec3(at.x(), at.y(), radius)).norm(), rounding)
            << "radius " << radius << " scale " << scale << " step " << i;
        ASSERT_LE((answer.force - Vec3(0, 0, stiffness * depth)).norm(), stiffness * rounding);
      }
      EXPECT_FALSE(world.to({at.x(), at.y(), 1.001 * radius}).contact);
    }
  }
}

TEST(BallProxy, RollsOverARidgeAndRestsInAGroove) {
  for (const double scale : unit_scales()) {
    for (const double radius : {2e-4, 1e-3, 3e-3}) {
      // Over the ridge of a roof of 90 degrees: the centre on the cylinder about the edge while the tip is above both
      // faces' normals there.
      World roof(synthetic::make_mesh("wedge", {}, 200).mesh, radius, scale);
      roof.to({-0.001, 0.003, 2.0 * radius});
      for (const double angle : testing::steps(-0.7, 0.7 + 0.025, 0.05)) {
        const Vec3 out(std::sin(angle), 0, std::cos(angle));
        const auto answer = roof.to(Vec3(0, 0.003 + 0.002 * angle, 0) + 0.8 * radius * out);
        ASSERT_LE((answer.center - Vec3(0, 0.003 + 0.002 * angle, 0) - radius * out).norm(), rounding)
            << angle << " radius " << radius << " scale " << scale;
        ASSERT_LE((answer.force - stiffness * 0.2 * radius * out).norm(), stiffness * rounding);
      }
      // In a groove of opening 2a the ball hangs between the walls: its centre r / sin a over the bottom.
      const double opening = 1.2;
      World groove(synthetic::make_mesh("v-groove", {{"opening_rad", opening}, {"depth_m", 0.02}}, 200).mesh, radius,
                   scale);
      const double hang = -0.02 + radius / std::sin(0.5 * opening);
      groove.stroke({0.0001, 0.001, 0.004}, {0.00005, 0.002, hang + 1e-5}, 60);
      const auto answer = groove.to({0.0001 * radius, 0.0041, hang - 0.4 * radius});
      ASSERT_LE((answer.center - Vec3(0, 0.0041, hang)).norm(), rounding) << "radius " << radius << " scale " << scale;
      ASSERT_LE((answer.force - stiffness * Vec3(-0.0001 * radius, 0, 0.4 * radius)).norm(), stiffness * rounding);
      // Of two walls the normal is neither's, but the direction in which both push.
      ASSERT_LE((answer.normal - answer.force.normalized()).norm(), 4.0 * eps) << answer.normal.transpose();
    }
  }
}

// Off a block's level top, over its edge and down before its side, as deep as the radius: the tip passes the edge's
// line at any distance, and in the step in which it has passed the ball rests before the side, a quarter of a turn on.
TEST(BallProxy, RollsOverASharpEdgeInOneStepAtAnyDistanceFromItsLine) {
  for (const double scale : unit_scales()) {
    for (const double radius : {3e-4, 1e-3, 5e-3}) {
      for (double offset = 1e-9; offset < 1e-3; offset *= 3.7) {
        if (offset > 0.5 * radius) continue;
        for (const double below : {0.4, 1.0, 2.5}) {
          World block(testing::cube(0.02), radius, scale);
          const double y = 0.0013;
          // The top is at z = 0.02, the edge at x = 0.02.
          const auto at = [&](double x, double z) { return Vec3(0.02 + x, y, 0.02 + z); };
          block.stroke(at(-3.0 * radius, 2.0 * radius), at(-2.0 * radius, -below * offset), 10);
          const auto before = block.stroke(at(-2.0 * radius, -below * offset), at(-offset, -below * offset), 30);
          ASSERT_LE((before.center - at(-offset, radius)).norm(), rounding) << offset << " radius " << radius;
          const auto after = block.to(at(offset, -below * offset));
          ASSERT_LE((after.center - at(radius, -below * offset)).norm(), rounding)
              << "offset " << offset << " radius " << radius << " scale " << scale << ": "
              << (after.center - at(0, 0)).transpose();
          ASSERT_LE((after.force - stiffness * Vec3(radius - offset, 0, 0)).norm(), stiffness * rounding);
          // On the arc, where the tip is beyond both faces.
          const Vec3 out = Vec3(1.0, 0.0, below).normalized();
          const auto on_arc = block.to(at(0, 0) + offset * out);
          ASSERT_LE((on_arc.center - at(0, 0) - radius * out).norm(), radius / offset * rounding) << offset;
        }
      }
    }
  }
}

TEST(BallProxy, RestsInACornerUnderThreePlanes) {
  TriangleMesh box = testing::cube(0.02);
  for (auto& triangle : box.triangles) std::swap(triangle[1], triangle[2]);
  for (const double scale : unit_scales()) {
    for (const double radius : {1e-4, 1e-3, 5e-3}) {
      World room(box, radius, scale);
      room.to({0.001, 0.002, 0.003});
      const double inner = 0.02 - radius;
      const auto corner = room.to({0.023, 0.0216, -0.0204});
      ASSERT_LE((corner.center - Vec3(inner, inner, -inner)).norm(), rounding)
          << "radius " << radius << " scale " << scale;
      ASSERT_LE((corner.normal - corner.force.normalized()).norm(), 4.0 * eps) << corner.normal.transpose();
      const auto edge = room.to({0.023, 0.0216, -0.5 * inner});
      ASSERT_LE((edge.center - Vec3(inner, inner, -0.5 * inner)).norm(), rounding);
      const auto face = room.to({0.023, 0.1 * inner, -0.5 * inner});
      ASSERT_LE((face.center - Vec3(inner, 0.1 * inner, -0.5 * inner)).norm(), rounding);
      EXPECT_FALSE(room.to({0.5 * inner, 0.1 * inner, -0.5 * inner}).contact);
    }
  }
}

TEST(BallProxy, DoesNotPassThroughThinShellsOrBodiesInJumps) {
  for (const double scale : unit_scales()) {
    for (const double radius : {1e-5, 1e-3}) {
      World shell(synthetic::make_mesh("thin-shell", {{"thickness_m", 5e-5}}, 200).mesh, radius, scale);
      shell.to({0.001, 0.002, 0.01});
      for (const double z : {0.5 * radius, -2e-5, -1e-3, -2e-2}) {
        const auto answer = shell.to({0.001, 0.002, z});
        ASSERT_LE((answer.center - Vec3(0.001, 0.002, radius)).norm(), rounding)
            << "radius " << radius << " scale " << scale << " z " << z;
      }
      const auto far = shell.stroke({0.001, 0.002, -2e-2}, {0.02, -0.01, -2e-2}, 40);
      ASSERT_LE((far.center - Vec3(0.02, -0.01, radius)).norm(), rounding);
      ASSERT_FALSE(shell.to({0.02, -0.01, 1.01 * radius}).contact);
    }
  }
}

TEST(BallProxy, FollowsSmoothBodiesToWithinTheirTessellation) {
  for (const char* name : {"sphere", "bumpy", "torus", "gauss"}) {
    const auto shape = synthetic::make_surface(name);
    const auto tessellation = shape->tessellate(20000);
    for (const double radius : {1e-4, 1e-3, 3e-3}) {
      const auto renderer = god_object(tessellation.mesh, stiffness, radius);
      Hand hand(*renderer);
      Random random(12);
      SurfacePoint foot =
          shape->closest(shape->bounds().center() + Vec3(0.001, 0.0007, shape->bounds().sizes().norm()));
      hand.to(foot.p_W_m + 3.0 * radius * foot.n_W);
      Vec3 along = random.direction();
      for (int i = 0; i < 1000; ++i) {
        const double depth = 3e-4 * std::min(1.0, i / 100.0);
        const Vec3 p = foot.p_W_m + (radius - depth) * foot.n_W;
        const StepResult result = hand.to(p);
        const auto exact = synthetic::exact_contact(*shape, p, stiffness, radius);
        ASSERT_NEAR(result.depth_m, exact.depth_m, tessellation.deviation_bound_m + 1e-12)
            << name << " radius " << radius << " step " << i;
        if (i % 200 == 199) along = random.direction();
        foot = shape->closest(foot.p_W_m + 5e-5 * (along - along.dot(foot.n_W) * foot.n_W));
        if (!shape->closed() && foot.p_W_m.cwiseAbs().maxCoeff() > 0.03) along = -foot.p_W_m.normalized();
      }
    }
  }
}

TEST(BallProxy, ATinyBallIsThePointTip) {
  const auto shape = synthetic::make_surface("bumpy");
  const auto mesh = shape->tessellate(2000).mesh;
  for (const double radius : {1e-6, 1e-9}) {
    const auto ball = god_object(mesh, stiffness, radius);
    const auto point = god_object(mesh, stiffness);
    Hand ball_hand(*ball);
    Hand point_hand(*point);
    Random random(13);
    SurfacePoint foot = shape->closest({0.001, 0.0007, 0.06});
    ball_hand.to(foot.p_W_m + 0.001 * foot.n_W);
    point_hand.to(foot.p_W_m + 0.001 * foot.n_W);
    Vec3 along = random.direction();
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = foot.p_W_m - 5e-4 * foot.n_W;
      const StepResult a = ball_hand.to(p);
      const StepResult b = point_hand.to(p);
      // In a valley the ball hangs a little higher: by r (1 / sin(half the opening) - 1), here less than r.
      ASSERT_LE((a.contact_W_m - b.contact_W_m).norm(), 2.5 * radius + 1e-13) << "radius " << radius << " step " << i;
      if (i % 100 == 99) along = random.direction();
      foot = shape->closest(foot.p_W_m + 3e-5 * (along - along.dot(foot.n_W) * foot.n_W));
    }
  }
}

TEST(BallProxy, StartingInsideItIsAtTheClosestPlaceOutside) {
  const TriangleMesh cube = testing::cube(0.02);
  for (const double scale : unit_scales()) {
    for (const double radius : {1e-4, 1e-3, 1e-2}) {
      for (const double height : {0.019, 0.02, 0.0200001}) {
        World world(cube, radius, scale);
        const auto answer = world.to({0.003, 0.004, height});
        ASSERT_TRUE(answer.contact);
        ASSERT_LE((answer.center - Vec3(0.003, 0.004, 0.02 + radius)).norm(), rounding) << radius << " " << height;
      }
    }
  }
}

TEST(BallProxy, DistanceToTheMeshNeverFallsBelowTheRadius) {
  for (const char* name : {"bumpy", "duck", "extrusion", "gap", "bowl"}) {
    const auto mesh = synthetic::make_mesh(name, {}, 3000).mesh;
    const auto surface = make_embree_surface(mesh);
    const double size = surface->bounds().sizes().norm();
    for (const double radius : {2e-4, 2e-3}) {
      const auto renderer = god_object(mesh, stiffness, radius);
      Hand hand(*renderer);
      Random random(14);
      Vec3 p = surface->bounds().center() + Vec3(0, 0, size);
      Vec3 target = p;
      hand.to(p);
      for (int i = 0; i < 1500; ++i) {
        if (i % 50 == 0) target = surface->bounds().center() + 0.4 * size * random.uniform() * random.direction();
        p += 0.05 * (target - p) + 1e-4 * random.direction();
        const StepResult result = hand.to(p);
        ASSERT_GE(surface->signed_distance(result.contact_W_m), radius * (1.0 - 1e-9))
            << name << " radius " << radius << " step " << i;
      }
    }
  }
}

// The triangles kept from earlier steps against those that the tree finds anew at each: the same path, bit for bit,
// with friction, which sends the ball to several goals in a step, as without.
TEST(BallProxy, WithItsNeighbourhoodKeptIsWhatAskingTheTreeGives) {
  std::size_t touched = 0;
  for (const std::string name : {"bumpy", "torus", "v-groove", "gauss"}) {
    for (const auto& [scale, mu] :
         {std::pair{1e-3, 0.0}, {1.0, 0.0}, {1e3, 0.0}, {1e-3, 0.3}, {1.0, 0.3}, {1e3, 0.3}}) {
      const TriangleMesh mesh = surface::moved(synthetic::make_mesh(name, {}, 2000).mesh, awkward_rotation(),
                                               scale * Vec3(0.01, -0.02, 0.005), scale);
      const auto surface = make_embree_surface(mesh);
      const ContactMesh contact(*surface);
      const double radius = 1e-3 * scale;
      BallProxy kept(contact, *surface, radius, {mu, mu});
      BallProxy asked(contact, *surface, radius, {mu, mu});
      Random random(31);
      Vec3 way = random.direction();
      for (int i = 0; i < 1500; ++i) {
        way = (way + 0.01 * random.direction()).normalized();
        const SurfacePoint foot = surface->closest(surface->bounds().center() + 0.04 * scale * way);
        const Vec3 p = foot.p_W_m + (0.6 - 0.7 * std::sin(0.02 * i)) * radius * foot.n_W;
        if (i == 0) {
          kept.start(p);
          asked.start(p);
        } else {
          asked.forget_near();
          kept.follow(p);
          asked.follow(p);
        }
        ASSERT_EQ(kept.position(), asked.position()) << name << " x " << scale << " mu " << mu << " step " << i;
        ASSERT_EQ(kept.touching(), asked.touching()) << name << " x " << scale << " mu " << mu << " step " << i;
        touched += kept.touching() ? 1U : 0U;
      }
      EXPECT_LT(kept.gathers(), asked.gathers() / 2);
    }
  }
  EXPECT_GT(touched, 10000U);
}

}  // namespace
}  // namespace touchstone::renderers
