// Bodies put together from parts: tops that are flush make one floor, whatever lies below it. The exact answer is that
// of the floor alone, k depth along its normal, for every renderer with a point tip and no friction; with friction it
// is what one box over the same ground gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "renderers/mesh_traversal/exposed_place.h"
#include "renderers/mesh_traversal/flush.h"
#include "renderers/mesh_traversal/mesh_regularity.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::TriangleMesh;

namespace {

constexpr double stiffness = 7000.0;
constexpr double press_depth = 0.75e-3;
// Of the largest force, 5 N: what the arithmetic of planes at 0.2 m from the origin leaves.
constexpr double rounding_N = 1e-9;

TriangleMesh box(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh = testing::cube(1.0);
  for (Vec3& v : mesh.vertices_W_m) {
    for (Eigen::Index i = 0; i < 3; ++i) v[i] = v[i] < 0.0 ? low[i] : high[i];
  }
  return mesh;
}

void append(TriangleMesh& to, const TriangleMesh& other) {
  const auto offset = static_cast<std::int32_t>(to.vertices_W_m.size());
  to.vertices_W_m.insert(to.vertices_W_m.end(), other.vertices_W_m.begin(), other.vertices_W_m.end());
  for (const auto& [i, j, k] : other.triangles) to.triangles.push_back({i + offset, j + offset, k + offset});
}

// Every triangle cut into four.
TriangleMesh refined(const TriangleMesh& mesh) {
  TriangleMesh fine;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](std::int32_t i) { return mesh.vertices_W_m[static_cast<std::size_t>(i)]; };
    const auto first = static_cast<std::int32_t>(fine.vertices_W_m.size());
    for (const Vec3& v :
         {at(a), at(b), at(c), Vec3(0.5 * (at(a) + at(b))), Vec3(0.5 * (at(b) + at(c))), Vec3(0.5 * (at(c) + at(a)))})
      fine.vertices_W_m.push_back(v);
    for (const std::array<std::int32_t, 3>& t :
         {std::array{0, 3, 5}, std::array{3, 1, 4}, std::array{5, 4, 2}, std::array{3, 4, 5}})
      fine.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return fine;
}

// A floor at z = 0 for x from -30 to 30 mm and y from -10 to 10 mm at least, made of bodies.
struct Floor {
  std::string name;
  std::vector<TriangleMesh> bodies;
};

std::vector<Floor> floors() {
  const auto part = [](double from, double to, double low = -0.03, double side = 0.02) {
    return box({from, -side, low}, {to, side, 0.0});
  };
  std::vector<Floor> all;
  all.push_back({"one", {part(-0.04, 0.04)}});
  all.push_back({"abutting", {part(-0.04, 0.003), part(0.003, 0.04)}});
  all.push_back({"abutting, not alike", {part(-0.04, 0.003), part(0.003, 0.04, -0.011, 0.013)}});
  all.push_back({"overlapping by 1 mm", {part(-0.04, 0.003), part(0.002, 0.04)}});
  all.push_back({"overlapping, not alike", {part(-0.04, 0.003, -0.02, 0.017), part(0.002, 0.04)}});
  all.push_back({"one within another", {part(-0.04, 0.04), part(-0.01, 0.012, -0.01, 0.005)}});
  Floor row{"ten in a row", {}};
  Floor overlapping{"ten that overlap", {}};
  for (int i = 0; i < 10; ++i) {
    row.bodies.push_back(part(-0.04 + i * 0.008, -0.04 + (i + 1) * 0.008));
    overlapping.bodies.push_back(part(-0.04 + i * 0.008 - 0.001, -0.04 + (i + 1) * 0.008 + 0.001,
                                      i % 2 == 0 ? -0.03 : -0.02, i % 3 == 0 ? 0.02 : 0.015));
  }
  all.push_back(row);
  all.push_back(overlapping);
  // The floor is the side of a stack: boxes of equal width on one another, turned so that their sides are the top.
  Floor stack{"a stack's side", {}};
  for (int i = 0; i < 4; ++i) stack.bodies.push_back(part(-0.04 + 0.02 * i, -0.02 + 0.02 * i, -0.04, 0.02));
  all.push_back(stack);
  all.push_back({"doubled", {part(-0.04, 0.04), part(-0.04, 0.04)}});
  // Four about a corner, and triangles whose corners lie on others' edges.
  all.push_back({"four about a corner",
                 {box({-0.04, -0.02, -0.03}, {0.001, 0.0015, 0.0}), box({0.001, -0.02, -0.03}, {0.04, 0.0015, 0.0}),
                  box({-0.04, 0.0015, -0.03}, {0.001, 0.02, 0.0}), box({0.001, 0.0015, -0.03}, {0.04, 0.02, 0.0})}});
  all.push_back({"T-junctions", {refined(part(-0.04, 0.003)), part(0.003, 0.04)}});
  return all;
}

// Bodies and triangles in an order of the seed, in a pose, at a scale.
struct Scene {
  Quat turn;
  Vec3 shift;
  double scale;
  TriangleMesh mesh;

  Scene(std::vector<TriangleMesh> bodies, std::uint64_t seed, const Quat& turn_, double scale_)
      : turn(turn_), shift(scale_ * Vec3(0.011, -0.023, 0.0057)), scale(scale_) {
    Random random(seed);
    const auto shuffled = [&](auto& list) {
      for (std::size_t i = list.size(); i > 1; --i)
        std::swap(list[i - 1], list[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    };
    if (seed > 0) shuffled(bodies);
    for (const TriangleMesh& body : bodies) append(mesh, surface::moved(body, turn, shift, scale));
    if (seed > 0) shuffled(mesh.triangles);
  }
  [[nodiscard]] Vec3 at(const Vec3& p) const { return turn * (scale * p) + shift; }
  [[nodiscard]] std::unique_ptr<rendering::Renderer> renderer(const std::string& name,
                                                              std::map<std::string, double> parameters = {}) const {
    parameters["stiffness_N_per_m"] = stiffness / scale;
    return make_renderer(model_of(name, std::move(parameters)), make_embree_surface(mesh));
  }
};

const std::vector<Quat>& poses() {
  static const std::vector<Quat> all{Quat::Identity(), Quat(Eigen::AngleAxisd(0.1, Vec3(0.2, 1.0, 0.1).normalized())),
                                     awkward_rotation()};
  return all;
}

// Strokes over the joints: to and fro, slowly, fast, aslant.
const std::vector<std::function<Vec3(double)>>& strokes() {
  static const std::vector<std::function<Vec3(double)>> all{
      [](double s) { return Vec3(-0.02 + 0.04 * s, 0.001, -press_depth); },
      [](double s) { return Vec3(0.02 - 0.04 * s, -0.0023, -press_depth); },
      [](double s) { return Vec3(-0.0273 + 0.0513 * s, -0.0061 + 0.0117 * s, -press_depth * (1.0 - 0.9 * s)); },
      [](double s) {
        return Vec3(0.001 + 0.0005 * std::sin(40.0 * s), 0.0015 + 0.0007 * std::cos(31.0 * s), -press_depth);
      }};
  return all;
}

TEST(FlushBodies, AreOneFloorForEveryRendererInAnyOrderPoseAndScale) {
  for (const Floor& floor : floors()) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      for (const Quat& pose : poses()) {
        for (const std::uint64_t seed : {0U, 1U, 2U}) {
          const Scene scene(floor.bodies, seed, pose, scale);
          const char* const name = seed == 0 ? "god-object" : seed == 1 ? "friction-cone" : "force-shading";
          const auto renderer = scene.renderer(name);
          const Vec3 up = pose * Vec3::UnitZ();
          for (const auto& stroke : strokes()) {
            Hand hand(*renderer);
            hand.to(scene.at(stroke(0.0) + Vec3(0, 0, 0.002)));
            for (int i = 0; i <= 200; ++i) {
              const Vec3 p = stroke(i / 200.0);
              const StepResult result = hand.to(scene.at(p));
              ASSERT_TRUE(result.contact) << floor.name << ", " << name << ", scale " << scale << ", step " << i;
              ASSERT_LE((result.f_W_N + stiffness * p.z() * up).norm(), rounding_N)
                  << floor.name << ", " << name << ", scale " << scale << ", order " << seed << ", step " << i
                  << ", at " << p.transpose() << ": " << (pose.conjugate() * result.f_W_N).transpose();
            }
          }
        }
      }
    }
  }
}

TEST(FlushBodies, FrictionIsThatOfOneBox) {
  const std::vector<Floor> all = floors();
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const Quat& pose : poses()) {
      const Scene whole(all[0].bodies, 0, pose, scale);
      for (std::size_t i = 1; i < all.size(); ++i) {
        const Scene parts(all[i].bodies, i, pose, scale);
        for (const char* const name : {"friction-cone", "force-shading"}) {
          const std::map<std::string, double> friction{{"mu_static", 0.5}, {"mu_dynamic", 0.3}};
          const auto one = whole.renderer(name, friction);
          const auto several = parts.renderer(name, friction);
          for (const auto& stroke : strokes()) {
            Hand over_one(*one);
            Hand over_several(*several);
            const Vec3 above = stroke(0.0) + Vec3(0, 0, 0.002);
            over_one.to(whole.at(above));
            over_several.to(parts.at(above));
            for (int step = 0; step <= 200; ++step) {
              const Vec3 p = stroke(step / 200.0);
              const StepResult expected = over_one.to(whole.at(p));
              const StepResult result = over_several.to(parts.at(p));
              ASSERT_LE((result.f_W_N - expected.f_W_N).norm(), rounding_N)
                  << all[i].name << ", " << name << ", scale " << scale << ", step " << step;
            }
          }
        }
      }
    }
  }
}

TEST(FlushBodies, SinglePrecisionMakesNoWall) {
  for (const Floor& floor : floors()) {
    for (const Quat& pose : poses()) {
      Scene scene(floor.bodies, 5, pose, 1.0);
      for (Vec3& v : scene.mesh.vertices_W_m) v = v.cast<float>().cast<double>();
      const auto renderer = scene.renderer("god-object");
      const Vec3 up = pose * Vec3::UnitZ();
      // Heights off by what counts as flush.
      const double off_N = stiffness * flush_m(0.1);
      for (const auto& stroke : strokes()) {
        Hand hand(*renderer);
        hand.to(scene.at(stroke(0.0) + Vec3(0, 0, 0.002)));
        for (int i = 0; i <= 500; ++i) {
          const Vec3 p = stroke(i / 500.0);
          const StepResult result = hand.to(scene.at(p));
          // The planes lean by what their corners are off over the smallest box, 7 mm.
          const double lean_N = stiffness * press_depth * flush_m(0.1) / 7e-3;
          ASSERT_LE((result.f_W_N + stiffness * p.z() * up).norm(), off_N + lean_N)
              << floor.name << ", step " << i << ": " << (pose.conjugate() * result.f_W_N).transpose();
        }
      }
    }
  }
}

TEST(FlushBodies, FreeJustAboveTheFloorAndHardlyHeldJustBelow) {
  for (const Floor& floor : floors()) {
    for (const Quat& pose : poses()) {
      const Scene scene(floor.bodies, 3, pose, 1.0);
      const auto renderer = scene.renderer("god-object");
      for (const double height : {1e-6, 1e-8, 1e-10, 0.0, -1e-10, -1e-8, -1e-6}) {
        // Along a row of joints' corners too, where the way passes through corners and edges exactly.
        for (const double y : {0.001, 0.0015, 0.0}) {
          Hand hand(*renderer);
          for (int i = 0; i <= 200; ++i) {
            const StepResult result = hand.to(scene.at({-0.02 + 2e-4 * i, y, height}));
            ASSERT_LE(result.f_W_N.norm(), stiffness * std::max(0.0, -height) + rounding_N)
                << floor.name << ", pose " << &pose - poses().data() << ", height " << height << ", y " << y
                << ", step " << i << ": " << (pose.conjugate() * result.f_W_N).transpose();
          }
        }
      }
    }
  }
}

// Exactly at the floor's height, where rounding alone puts the tip above or below it, and along joints, where the way
// runs through edges and corners.
TEST(FlushBodies, ATipInTheFloorItselfTouchesNothing) {
  for (const Floor& floor : floors()) {
    for (const Quat& pose : poses()) {
      for (const double scale : {1e-3, 1.0, 1e3}) {
        for (const std::uint64_t seed : {0U, 4U, 5U}) {
          const Scene scene(floor.bodies, seed, pose, scale);
          const auto renderer = scene.renderer(seed == 4 ? "force-shading" : "god-object");
          Random random(seed + 1);
          const auto on_floor = [&] {
            return Vec3(-0.03 + 0.06 * random.uniform(), -0.01 + 0.02 * random.uniform(), 0.0);
          };
          for (int line = 0; line < 8; ++line) {
            Vec3 a = on_floor();
            Vec3 b = on_floor();
            if (line % 4 == 1) a.y() = b.y() = 0.0015;
            if (line % 4 == 2) a.x() = b.x() = 0.003;
            if (line % 4 == 3) a.x() = b.x() = 0.001;
            Hand hand(*renderer);
            for (int i = 0; i <= 60; ++i) {
              const StepResult result = hand.to(scene.at(a + i / 60.0 * (b - a)));
              ASSERT_LE(result.f_W_N.norm(), rounding_N)
                  << floor.name << ", pose " << &pose - poses().data() << ", scale " << scale << ", order " << seed
                  << ", line " << line << ", step " << i << ": " << (pose.conjugate() * result.f_W_N).transpose();
            }
          }
        }
      }
    }
  }
}

// What is larger than what counts as flush is an obstacle: a step upwards, a wall that stands on the floor, its foot
// below it.
TEST(FlushBodies, StepsAndWallsHold) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const Quat& pose : poses()) {
      for (const double rise : {5e-6, 1e-3, 0.02}) {
        for (const double low : {-0.03, -0.004, 0.0}) {
          const Scene scene(
              {box({-0.04, -0.02, -0.03}, {0.04, 0.02, 0.0}), box({0.005, -0.01, low}, {0.03, 0.01, rise})}, 7, pose,
              scale);
          const auto renderer = scene.renderer("god-object");
          Hand hand(*renderer);
          hand.to(scene.at({-0.02, 0.001, 0.002}));
          for (int i = 0; i <= 200; ++i) {
            const Vec3 p(-0.02 + 2e-4 * i, 0.001 + 1e-5 * i, -press_depth);
            const StepResult result = hand.to(scene.at(p));
            const Vec3 expected = stiffness * Vec3(std::min(0.0, 0.005 - p.x()), 0.0, press_depth);
            ASSERT_LE((pose.conjugate() * result.f_W_N - expected).norm(), 1e-8 * (1.0 + expected.norm()))
                << "rise " << rise << ", low " << low << ", scale " << scale << ", step " << i;
          }
        }
      }
    }
  }
}

// Off the end of the floor, round its rim and down the outside, past joints between stacked bodies.
TEST(FlushBodies, TheSideOfAStackIsOneWall) {
  for (const Quat& pose : poses()) {
    std::vector<TriangleMesh> stack;
    for (int i = 0; i < 5; ++i) stack.push_back(box({-0.02, -0.02, 0.01 * i}, {0.02, 0.02, 0.01 * (i + 1)}));
    const Scene scene(stack, 4, pose, 1.0);
    for (const char* const name : {"god-object", "friction-cone", "force-shading"}) {
      const auto renderer = scene.renderer(name);
      for (const double from : {0.045, 0.004}) {
        Hand hand(*renderer);
        hand.to(scene.at({0.025, 0.003, from}));
        for (int i = 0; i <= 300; ++i) {
          const double z = from + (0.049 - 2 * from) * i / 300.0;
          const StepResult result = hand.to(scene.at({0.02 - press_depth, 0.003, z}));
          const Vec3 expected = stiffness * press_depth * (pose * Vec3::UnitX());
          ASSERT_LE((result.f_W_N - expected).norm(), rounding_N) << name << ", step " << i;
        }
      }
    }
  }
}

TEST(FlushBodies, ARunThatStartsInsideStartsOnTheOutside) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const Floor& floor : floors()) {
      const Scene scene(floor.bodies, 2, awkward_rotation(), scale);
      const auto renderer = scene.renderer("god-object");
      for (const double x : {-0.013, 0.0005, 0.0021, 0.0025, 0.0029, 0.003, 0.0031}) {
        Hand hand(*renderer);
        const StepResult result = hand.to(scene.at({x, 0.0007, -press_depth}));
        const Vec3 f = awkward_rotation().conjugate() * result.f_W_N;
        EXPECT_LE((f - Vec3(0, 0, stiffness * press_depth)).norm(), rounding_N)
            << floor.name << ", x " << x << ", scale " << scale << ": " << f.transpose();
      }
    }
  }
}

// A ball whose centre begins inside, beside inner walls nearer than the floor and on them: its centre comes to rest a
// radius above the floor, and stays there when the tip slides on.
TEST(FlushBodies, ABallThatStartsInsideStartsOnTheOutside) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const Floor& floor : floors()) {
      const Scene scene(floor.bodies, 2, awkward_rotation(), scale);
      for (const double radius : {1e-4, 1e-3, 3e-3}) {
        const auto renderer = scene.renderer("god-object", {{"tip_radius_m", radius * scale}});
        for (const double x : {-0.013, 0.0005, 0.00099, 0.0021, 0.0025, 0.0029, 0.003, 0.0031}) {
          for (const double depth : {press_depth, 3.0 * press_depth}) {
            Hand hand(*renderer);
            for (int i = 0; i < 5; ++i) {
              const StepResult result = hand.to(scene.at({x + 1e-4 * i, 0.0007, -depth}));
              const Vec3 f = awkward_rotation().conjugate() * result.f_W_N;
              ASSERT_LE((f - Vec3(0, 0, stiffness * (radius + depth))).norm(), rounding_N)
                  << floor.name << ", x " << x << ", depth " << depth << ", radius " << radius << ", scale " << scale
                  << ", step " << i << ": " << f.transpose();
            }
          }
        }
      }
    }
  }
}

TEST(FlushBodies, WindingIsCountedNotCancelled) {
  const Scene scene({box({0, 0, 0}, {2, 2, 2}), box({1, 0.5, 0.25}, {3, 1.5, 1.75})}, 1, awkward_rotation(), 1.0);
  const auto surface = make_embree_surface(scene.mesh);
  const ContactMesh mesh(*surface);
  EXPECT_EQ(winding_about(mesh, scene.at({0.5, 1.0, 1.0})), 1);
  EXPECT_EQ(winding_about(mesh, scene.at({1.5, 1.0, 1.0})), 2);
  EXPECT_EQ(winding_about(mesh, scene.at({2.5, 1.0, 1.0})), 1);
  EXPECT_EQ(winding_about(mesh, scene.at({2.5, 1.0, 1.9})), 0);
  EXPECT_EQ(winding_about(mesh, scene.at({-1.0, 1.0, 1.0})), 0);
}

TEST(FlushBodies, BodiesApartAreWalkedOnTouchingOnesAreNot) {
  const auto irregular = [](double gap_m) {
    TriangleMesh mesh = box({-0.04, -0.02, -0.03}, {0.0, 0.02, 0.0});
    append(mesh, box({gap_m, -0.013, -0.02}, {0.04, 0.013, -0.001}));
    const surface::TriangleTree tree(mesh);
    const auto regular = regular_triangles(mesh, make_topology(mesh), tree);
    return std::count(regular.begin(), regular.end(), false);
  };
  EXPECT_EQ(irregular(1e-6), 0);
  EXPECT_EQ(irregular(4.0 * flush_m(0.04)), 0);
  EXPECT_GT(irregular(1e-17), 0);
  EXPECT_GT(irregular(0.0), 0);
  EXPECT_GT(irregular(-1e-17), 0);
  EXPECT_GT(irregular(-1e-3), 0);
}

// Two ridges across one another: neither has a corner near the other, their edges alone come close, off the middle of
// both.
TEST(FlushBodies, EdgesThatCrossCloselyAreFound) {
  const auto irregular = [](double gap_m) {
    // A tetrahedron with its ridge along x, and one turned over with its ridge along y above it.
    TriangleMesh mesh;
    mesh.vertices_W_m = {{-0.03, 0, 0},        {0.05, 0, 0},        {0.01, -0.02, -0.03}, {0.01, 0.02, -0.03},
                         {0.02, -0.01, gap_m}, {0.02, 0.04, gap_m}, {0.0, 0.01, 0.03},    {0.04, 0.01, 0.03}};
    mesh.triangles = {{0, 1, 3}, {1, 0, 2}, {0, 3, 2}, {1, 2, 3}, {4, 5, 6}, {5, 4, 7}, {4, 6, 7}, {5, 7, 6}};
    const surface::TriangleTree tree(mesh);
    const auto regular = regular_triangles(mesh, make_topology(mesh), tree);
    return std::count(regular.begin(), regular.end(), false);
  };
  const double flush = flush_m(0.05);
  EXPECT_EQ(irregular(4.0 * flush), 0);
  EXPECT_EQ(irregular(0.5 * flush), 4) << "the two faces at each ridge";
}

}  // namespace
}  // namespace touchstone::renderers
