// The god-object of a point tip against exact answers.
#include "renderers/proxy/god_object.h"

#include <gtest/gtest.h>

#include <numbers>

#include "harness/base/random.h"
#include "harness/rendering/seam_watch.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::TriangleMesh;

namespace {

constexpr double stiffness = 500.0;
constexpr double eps = std::numeric_limits<double>::epsilon();

// A shape of synthetic/ put into an awkward pose at a scale, with the way back and forth.
struct World {
  TriangleMesh mesh;
  Quat turn;
  Vec3 shift;
  double scale;

  World(const std::string& name, const synthetic::ParameterOverrides& overrides, std::size_t triangles, double scale_)
      : World(synthetic::make_mesh(name, overrides, triangles).mesh, scale_) {}
  World(const TriangleMesh& mesh_, double scale_)
      : turn(awkward_rotation()), shift(scale_ * Vec3(0.01, -0.02, 0.005)), scale(scale_) {
    mesh = surface::moved(mesh_, turn, shift, scale);
  }
  [[nodiscard]] Vec3 at(const Vec3& p) const { return turn * (scale * p) + shift; }
  [[nodiscard]] Vec3 direction(const Vec3& v) const { return turn * v; }
  // A length in the shape's own frame and unit.
  [[nodiscard]] Vec3 back(const Vec3& v) const { return turn.conjugate() * v / scale; }
  // Rounding of a position in the shape's own unit, some operations deep.
  static double rounding() { return 64.0 * eps * 0.1; }
};

// Two sheets side by side, the right one higher by `step_m`. A tip that slides below the edge of the higher one is
// lost, and the watch says where; over one that is lower, over the rim and up out of contact it says nothing.
TEST(GodObject, AWatchSaysWhereATipFallsThroughASeam) {
  const auto lost = [](double step_m, double to_x, bool up) {
    TriangleMesh mesh;
    for (const double x : {-0.03, 0.004}) {
      const double z = x > 0.0 ? step_m : 0.0;
      const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
      const double end = x > 0.0 ? 0.04 : 0.004;
      for (const Vec3& corner : {Vec3(x, -0.01, z), Vec3(end, -0.01, z), Vec3(end, 0.02, z), Vec3(x, 0.02, z)})
        mesh.vertices_W_m.push_back(corner);
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
    const auto surface = make_embree_surface(mesh);
    const auto search = std::make_shared<rendering::SeamSearch>(surface);
    rendering::SeamWatch watched(god_object(mesh, stiffness), search);
    Hand hand(watched);
    hand.to({-0.01, 0.003, 0.001});
    for (double x = -0.01; x < to_x; x += 3e-5) hand.to({x, 0.003, -7e-4});
    if (up) hand.to({to_x, 0.003, 1e-3});
    return search->losses();
  };
  const rendering::SeamLosses found = lost(5e-8, 0.02, false);
  EXPECT_EQ(found.count, 1U);
  EXPECT_NEAR(found.first_at_W_m.x(), 0.004, 6e-5);
  EXPECT_NEAR(found.first_depth_m, 7e-4, 1e-9);
  EXPECT_NE(seam_warning(found).find("open seam"), std::string::npos);
  EXPECT_EQ(lost(-5e-8, 0.02, false).count, 0U);
  EXPECT_EQ(lost(0.0, 0.02, false).count, 0U);
  EXPECT_EQ(lost(0.0, 0.05, false).count, 0U) << "over the outer rim";
  EXPECT_EQ(lost(0.0, 0.002, true).count, 0U);
  EXPECT_EQ(rendering::seam_warning({}), "");
}

TEST(GodObject, PressesAPlaneWithItsStiffnessAlongTheNormalOnly) {
  for (const double scale : unit_scales()) {
    const World world("plane", {}, 200, scale);
    const auto renderer = god_object(world.mesh, stiffness / scale);
    Hand hand(*renderer);
    EXPECT_FALSE(hand.to(world.at({0.001, 0.002, 0.004})).contact);
    Random random(1);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p(random.uniform(-0.04, 0.04), random.uniform(-0.04, 0.04), random.uniform(-0.01, -1e-9));
      const StepResult result = hand.to(world.at(p));
      ASSERT_TRUE(result.contact);
      EXPECT_LE((world.turn.conjugate() * result.f_W_N - Vec3(0, 0, -stiffness * p.z())).norm(),
                stiffness * World::rounding())
          << "scale " << scale << " step " << i;
      EXPECT_LE((world.back(result.contact_W_m - world.shift) - Vec3(p.x(), p.y(), 0)).norm(), World::rounding());
      EXPECT_NEAR(result.depth_m / scale, -p.z(), World::rounding());
      EXPECT_LE((result.n_W - world.direction(Vec3::UnitZ())).norm(), 8 * eps);
    }
  }
}

TEST(GodObject, NeverPullsAndStartsAndEndsWithNoForce) {
  for (const double scale : unit_scales()) {
    const World world("bumpy", {}, 2000, scale);
    const auto renderer = god_object(world.mesh, stiffness / scale);
    Hand hand(*renderer);
    Random random(2);
    for (int tap = 0; tap < 20; ++tap) {
      const Vec3 way = random.direction();
      StepResult before;
      for (int i = 0; i <= 400; ++i) {
        // In to the middle of the body's shell and out again, 20 um at a time.
        const double depth = i <= 200 ? i * 2e-5 : (400 - i) * 2e-5;
        const StepResult now = hand.to(world.at(way * (0.036 - depth * 3.0)));
        const Vec3 f = world.turn.conjugate() * now.f_W_N;
        EXPECT_GE(now.f_W_N.dot(now.n_W), 0.0);
        if (now.contact != before.contact) {
          // The first and last force is that of the part of one step that lies inside.
          EXPECT_LE((now.contact ? f : Vec3(world.turn.conjugate() * before.f_W_N)).norm(),
                    stiffness * 6e-5 * (1 + 1e-9));
        }
        EXPECT_TRUE(now.contact || now.f_W_N == Vec3::Zero());
        before = now;
      }
    }
  }
}

TEST(GodObject, HeldStillTheForceStaysToTheBit) {
  const World world("bumpy", {}, 2000, 1.0);
  const auto renderer = god_object(world.mesh, stiffness);
  Random random(3);
  for (int hold = 0; hold < 50; ++hold) {
    Hand hand(*renderer);
    const Vec3 way = random.direction();
    hand.stroke(world.at(0.06 * way), world.at(0.02 * way), 40);
    const StepResult first = hand.to(world.at(0.02 * way));
    for (int i = 0; i < 20; ++i) {
      const StepResult now = hand.to(world.at(0.02 * way));
      EXPECT_EQ(now.f_W_N, first.f_W_N);
      EXPECT_EQ(now.contact_W_m, first.contact_W_m);
    }
  }
}

TEST(GodObject, StaysOutsideAThinShellHoweverDeepItIsPushed) {
  for (const double thickness : {2e-3, 5e-4, 5e-5}) {
    for (const double scale : unit_scales()) {
      const World world("thin-shell", {{"thickness_m", thickness}}, 200, scale);
      const auto renderer = god_object(world.mesh, stiffness / scale);
      Hand hand(*renderer);
      hand.to(world.at({0, 0, 0.001}));
      // Through the shell to 20 mm below its far side in steps of all sizes, then along below it, then back.
      Vec3 p(0, 0, 0.001);
      for (const double step : {1e-5, 1e-4, 3e-3, 0.017}) {
        p.z() -= step;
        const StepResult result = hand.to(world.at(p));
        EXPECT_LE((world.turn.conjugate() * result.f_W_N - Vec3(0, 0, stiffness * std::max(0.0, -p.z()))).norm(),
                  stiffness * World::rounding());
      }
      const double depth = -p.z();
      const StepResult far = hand.stroke(world.at(p), world.at({0.03, 0.02, -depth}), 50);
      EXPECT_LE((world.turn.conjugate() * far.f_W_N - Vec3(0, 0, stiffness * depth)).norm(),
                stiffness * World::rounding());
      EXPECT_FALSE(hand.to(world.at({0.03, 0.02, 1e-6})).contact);
    }
  }
}

TEST(GodObject, StaysOnTheNearSideOfABodyThatTheTipJumpsThrough) {
  for (const double scale : unit_scales()) {
    const World world(testing::cube(0.02), scale);
    const auto renderer = god_object(world.mesh, stiffness / scale);
    Hand hand(*renderer);
    hand.to(world.at({0.003, 0.004, 0.05}));
    // Out at the other side in one step: the god-object stays on top and is dragged over the rim only by what follows.
    const StepResult through = hand.to(world.at({0.003, 0.004, -0.05}));
    ASSERT_TRUE(through.contact);
    EXPECT_LE((world.back(through.contact_W_m - world.shift) - Vec3(0.003, 0.004, 0.02)).norm(), World::rounding());
    EXPECT_LE((world.turn.conjugate() * through.f_W_N - Vec3(0, 0, stiffness * 0.07)).norm(),
              stiffness * World::rounding());
    // Pulled far to the side it slides to the edge, over it, down the side and away below, to where the tip is free.
    const StepResult around = hand.to(world.at({0.04, 0.004, -0.05}));
    EXPECT_FALSE(around.contact);
    EXPECT_EQ(around.contact_W_m, world.at({0.04, 0.004, -0.05}));
  }
}

// The two faces of a crease along y, z = -|x| tan(bend/2) (convex: positive bend): exact rest for a tip pressed into
// it.
TEST(GodObject, CreasesDownToAMicroradianAreExactAndNotSticky) {
  for (const double bend : {-1.0, -1e-1, -1e-3, -1e-6, -1e-9, 1e-9, 1e-6, 1e-3, 1e-1, 1.0}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const World world("crease", {{"bend_rad", bend}}, 400, scale);
      const auto renderer = god_object(world.mesh, stiffness / scale);
      Hand hand(*renderer);
      const double a = 0.5 * bend;
      const Vec3 right(std::sin(a), 0, std::cos(a));  // normal for x > 0
      const Vec3 left(-std::sin(a), 0, std::cos(a));
      const double depth = 1e-3;
      hand.to(world.at({-0.02, 0.001, 0.05}));
      // Across the edge along the path at constant depth below z = -|x| tan a (which the faces are).
      for (int i = 0; i <= 400; ++i) {
        const double x = -0.02 + i * 1e-4 + 1.7e-6;
        const Vec3 p(x, 0.001 + x / 7.0, -std::abs(x) * std::tan(a) - depth);
        const StepResult now = hand.to(world.at(p));
        ASSERT_TRUE(now.contact) << bend;
        const double hr = right.dot(p);
        const double hl = left.dot(p);
        // Nearest points on the two faces' half-planes; the edge's where neither strip holds the tip.
        Vec3 expected(0, p.y(), 0);
        const Vec3 on_right = p - hr * right;
        const Vec3 on_left = p - hl * left;
        if (bend < 0.0) {
          if (on_right.x() > 0.0 && hr < 0.0) expected = on_right;
          if (on_left.x() < 0.0 && hl < 0.0) expected = on_left;
        } else {
          // Over a ridge it goes on along its face as long as the foot is on it.
          expected = on_left.x() < 0.0 ? on_left : on_right;
        }
        ASSERT_LE((world.back(now.contact_W_m - world.shift) - expected).norm(),
                  World::rounding() * (1.0 + 1.0 / std::cos(a)))
            << "bend " << bend << " scale " << scale << " x " << x;
      }
    }
  }
}

TEST(GodObject, RestsInAGrooveAndInACorner) {
  for (const double scale : unit_scales()) {
    // A groove with its bottom along y at z = -depth: any tip below both walls within the normal cone rests on that
    // line.
    const World groove("v-groove", {{"opening_rad", 1.2}, {"depth_m", 0.005}}, 100, scale);
    const auto in_groove = god_object(groove.mesh, stiffness / scale);
    Hand hand(*in_groove);
    hand.to(groove.at({0.0002, 0.003, 0.002}));
    const StepResult bottom = hand.to(groove.at({0.0004, 0.0041, -0.008}));
    EXPECT_LE((groove.back(bottom.contact_W_m - groove.shift) - Vec3(0, 0.0041, -0.005)).norm(), World::rounding());
    EXPECT_LE((groove.turn.conjugate() * bottom.f_W_N - stiffness * Vec3(-0.0004, 0, 0.003)).norm(),
              stiffness * World::rounding());

    // The inside of a box: three planes hold the tip in its corner.
    TriangleMesh box = testing::cube(0.02);
    for (auto& triangle : box.triangles) std::swap(triangle[1], triangle[2]);
    const World room(box, scale);
    const auto in_room = god_object(room.mesh, stiffness / scale);
    Hand other(*in_room);
    other.to(room.at({0.001, 0.002, 0.003}));
    const StepResult corner = other.to(room.at({0.03, 0.025, -0.022}));
    EXPECT_LE((room.back(corner.contact_W_m - room.shift) - Vec3(0.02, 0.02, -0.02)).norm(), World::rounding());
    EXPECT_LE((room.turn.conjugate() * corner.f_W_N - stiffness * Vec3(-0.01, -0.005, 0.002)).norm(),
              stiffness * World::rounding());
    const StepResult edge = other.to(room.at({0.03, 0.025, -0.011}));
    EXPECT_LE((room.back(edge.contact_W_m - room.shift) - Vec3(0.02, 0.02, -0.011)).norm(), World::rounding());
    EXPECT_FALSE(other.to(room.at({0.019, 0.019, -0.019})).contact);
  }
}

TEST(GodObject, PowersOfTwoOfTheUnitChangeNoBit) {
  const TriangleMesh mesh = synthetic::make_mesh("duck", {}, 3000).mesh;
  const auto run = [&](double scale) {
    const auto renderer = god_object(surface::moved(mesh, Quat::Identity(), Vec3::Zero(), scale), 512.0 / scale);
    Hand hand(*renderer);
    Random random(4);
    std::vector<Vec3> forces;
    Vec3 p(0.1, 0.05, 0.02);
    for (int i = 0; i < 3000; ++i) {
      p += 0.05 * (0.04 * random.direction() - p);
      forces.push_back(hand.to(scale * p).f_W_N);
    }
    return forces;
  };
  const auto one = run(1.0);
  EXPECT_GT(std::count_if(one.begin(), one.end(), [](const Vec3& f) { return !f.isZero(0.0); }), 1000);
  for (const double scale : {std::ldexp(1.0, -20), 0.5, 1024.0}) EXPECT_EQ(run(scale), one) << scale;
}

TEST(GodObject, StartingInsideItIsAtTheClosestSurfacePoint) {
  const auto shape = synthetic::make_surface("bumpy");
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const World world(shape->tessellate(3000).mesh, scale);
    const auto surface = make_embree_surface(world.mesh);
    const auto renderer = god_object(world.mesh, stiffness / scale);
    Random random(5);
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = world.at(random.uniform(0.0, 0.03) * random.direction());
      const auto closest = surface->closest(p);
      const StepResult result = Hand(*renderer).to(p);
      ASSERT_EQ(result.contact, closest.signed_distance_m < 0.0);
      if (result.contact) {
        EXPECT_LE((result.contact_W_m - closest.p_W_m).norm() / scale, World::rounding());
        EXPECT_NEAR(result.depth_m / scale, closest.distance_m / scale, World::rounding());
      }
    }
  }
}

TEST(GodObject, AnOpenSheetStopsTheTipFromItsFrontAndLetsGoAtItsRim) {
  const World world(testing::grid(0.05, 10), 1.0);
  const auto renderer = god_object(world.mesh, stiffness);
  Hand hand(*renderer);
  // Starting below the sheet: in contact where the closest point is not on the rim, free where it is.
  EXPECT_TRUE(Hand(*renderer).to(world.at({0.013, 0.01, -0.002})).contact);
  EXPECT_FALSE(Hand(*renderer).to(world.at({0.06, 0.01, -0.002})).contact);
  // Sliding off the rim frees the tip; coming back from below it passes; from above it is stopped again.
  Hand other(*renderer);
  other.to(world.at({0.04, 0.0, 0.001}));
  EXPECT_TRUE(other.to(world.at({0.049, 0.0, -0.001})).contact);
  EXPECT_FALSE(other.to(world.at({0.051, 0.0, -0.001})).contact);
  EXPECT_FALSE(other.to(world.at({0.03, 0.0, -0.001})).contact);
  EXPECT_FALSE(other.to(world.at({0.03, 0.0, 0.001})).contact);
  EXPECT_TRUE(other.to(world.at({0.03, 0.0, -0.001})).contact);
}

TEST(GodObject, EdgesAndVerticesHitExactlyStopTheTip) {
  const TriangleMesh grid = testing::grid(0.064, 16);  // vertices at multiples of 8 mm, exact in binary
  for (const double scale : {0.25, 1.0, 1024.0}) {
    const TriangleMesh mesh = surface::moved(grid, Quat::Identity(), Vec3::Zero(), scale);
    const auto renderer = god_object(mesh, stiffness);
    for (const Vec3& foot :
         {Vec3(0, 0, 0), Vec3(0.008, 0.016, 0), Vec3(0.004, 0.008, 0), Vec3(0.004, 0.004, 0), Vec3(0.008, 0.003, 0)}) {
      for (const Vec3& from : {Vec3(0, 0, 0.004), Vec3(0.002, 0.001, 0.004), Vec3(-0.016, 0, 0.004)}) {
        Hand hand(*renderer);
        hand.to(scale * (foot + from));
        const StepResult result = hand.to(scale * (foot - from));
        ASSERT_TRUE(result.contact) << foot.transpose() << " from " << from.transpose();
        EXPECT_EQ(result.contact_W_m.z(), 0.0);
        EXPECT_LE((result.contact_W_m / scale - Vec3(foot.x() - from.x(), foot.y() - from.y(), 0)).norm(),
                  World::rounding());
      }
    }
  }
}

TEST(GodObject, SliversAndTinyTrianglesRenderAPlane) {
  for (const double scale : unit_scales()) {
    const World world("slivers", {}, 400, scale);
    const auto renderer = god_object(world.mesh, stiffness / scale);
    Hand hand(*renderer);
    Random random(6);
    hand.to(world.at({0.01, 0.01, 0.001}));
    for (int i = 0; i < 2000; ++i) {
      const double reach = random.log_uniform(1e-7, 0.04);
      const Vec3 p(reach * random.uniform(-1, 1), reach * random.uniform(-1, 1), -random.log_uniform(1e-9, 1e-2));
      const StepResult result = hand.to(world.at(p));
      ASSERT_TRUE(result.contact) << i;
      // A sliver's normal is known to eps times length over width (1e6 here), times how far the tip is from its
      // corners.
      ASSERT_LE((world.turn.conjugate() * result.f_W_N - Vec3(0, 0, -stiffness * p.z())).norm(),
                stiffness * 1e-2 * 1e6 * 64 * eps)
          << i;
    }
  }
}

TEST(GodObject, FollowsTheSmoothBodyToWithinItsTessellation) {
  for (const char* name : {"sphere", "bumpy", "torus", "gauss", "duck"}) {
    const auto shape = synthetic::make_surface(name);
    for (const std::size_t triangles : {2000, 20000}) {
      const auto tessellation = shape->tessellate(triangles);
      const auto renderer = god_object(tessellation.mesh, stiffness);
      Hand hand(*renderer);
      Random random(7);
      const Box3 box = shape->bounds();
      // From above onto the body, then along it at most 0.5 mm deep.
      Vec3 x = box.center() + Vec3(0.001, 0.0007, box.sizes().norm());
      hand.to(x);
      surface::SurfacePoint foot = shape->closest(x);
      Vec3 along = random.direction();
      for (int i = 0; i < 800; ++i) {
        const Vec3 p = foot.p_W_m - 5e-4 * std::min(1.0, i / 100.0) * foot.n_W;
        if (i % 200 == 0) along = random.direction();
        const auto exact = synthetic::exact_contact(*shape, p, stiffness, 0.0);
        const StepResult result = hand.to(p);
        // The depth differs by the deviation; the foot by what the facets' normals are off, which shows in the force.
        ASSERT_NEAR(result.depth_m, exact.depth_m, tessellation.deviation_bound_m + 1e-12) << name << " step " << i;
        const Vec3 next = foot.p_W_m + 5e-5 * (along - along.dot(foot.n_W) * foot.n_W);
        foot = shape->closest(next);
        if (!shape->closed() && foot.p_W_m.cwiseAbs().maxCoeff() > 0.04) along = -foot.p_W_m.normalized();
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
