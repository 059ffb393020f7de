// Friction inside the proxy's step: exact cases at every unit, invariants on every kind of surface.
#include "renderers/proxy/friction_cone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
namespace {

constexpr double kStiffness = 500.0;
constexpr double kEps = std::numeric_limits<double>::epsilon();

struct Coefficients {
  double mu_static, mu_dynamic;
};

std::unique_ptr<Renderer> cone(std::shared_ptr<const Surface> surface, double stiffness, Coefficients mu,
                               double radius_m = 0.0) {
  return make_renderer(model_of("friction-cone", {{"stiffness_N_per_m", stiffness},
                                                  {"mu_static", mu.mu_static},
                                                  {"mu_dynamic", mu.mu_dynamic},
                                                  {"tip_radius_m", radius_m}}),
                       std::move(surface));
}
std::unique_ptr<Renderer> cone(const TriangleMesh& mesh, double stiffness, Coefficients mu, double radius_m = 0.0) {
  return cone(make_embree_surface(mesh), stiffness, mu, radius_m);
}

struct Split {
  double normal_N, tangential_N;
};

Split split(const StepResult& step) {
  const double normal_N = step.f_W_N.dot(step.n_W);
  return {normal_N, (step.f_W_N - normal_N * step.n_W).norm()};
}

struct Shape {
  std::string name;
  TriangleMesh mesh;
};

// Flat, curved, saddle-shaped, with ridges and valleys, and not manifold.
std::vector<Shape> shapes() {
  const auto made = [](const std::string& name, std::size_t triangles) {
    return Shape{name, synthetic::make_mesh(name, {}, triangles).mesh};
  };
  TriangleMesh crossed = testing::cube(0.02);
  const TriangleMesh other =
      testing::moved(testing::cube(0.015), Quat(0.9, 0.1, 0.3, 0.2).normalized(), Vec3(0.01, 0.004, 0.012));
  const auto shift = static_cast<std::int32_t>(crossed.vertices_W_m.size());
  crossed.vertices_W_m.insert(crossed.vertices_W_m.end(), other.vertices_W_m.begin(), other.vertices_W_m.end());
  for (auto t : other.triangles) crossed.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return {made("plane", 200),    made("sphere", 800),    {"coarse sphere", testing::ball(0.03, 1)},
          made("bumpy", 1000),   made("torus", 800),     made("saddle", 600),
          made("v-groove", 100), made("extrusion", 100), {"cubes that cross", crossed},
          made("gauss", 500)};
}

// Strokes that press up to 1 mm deep over a shape, with taps into the air, all in the shape's own unit.
std::vector<Vec3> strokes(const Surface& at, double radius_m, std::uint64_t seed, int steps) {
  Random random(seed);
  const Vec3 middle = at.bounds().center();
  const Vec3 half = 0.5 * at.bounds().sizes();
  std::vector<Vec3> tips;
  Vec3 way = random.direction();
  Vec3 turn = random.direction();
  for (int i = 0; i < steps; ++i) {
    if (i % 150 == 0) turn = random.direction();
    // Half of the time it rests but for a tremor.
    if (i / 40 % 2 == 0) way = (way + 0.01 * turn).normalized();
    Vec3 from = middle + 1.5 * half.cwiseProduct(way);
    from.z() = half.z() < 0.2 * half.x() ? std::abs(from.z() - middle.z()) + middle.z() + 0.01 : from.z();
    const SurfacePoint foot = at.closest(from);
    const double depth = 1e-3 * (0.6 + 0.8 * std::sin(0.013 * i));
    tips.push_back(foot.p_W_m + (radius_m - depth) * foot.n_W + 1e-5 * random.direction());
  }
  return tips;
}

TEST(FrictionCone, BreaksAwayAtTheStaticCoefficientAndSlidesAtTheDynamic) {
  for (const double radius : {0.0, 0.001}) {
    for (const auto& [name, mesh] : shapes()) {
      const auto surface = make_embree_surface(mesh);
      const auto tips = strokes(*surface, radius, 11, 180);
      for (const double scale : unit_scales()) {
        const Quat turn = awkward_rotation();
        const Vec3 shift = scale * Vec3(0.01, -0.02, 0.005);
        const auto world = make_embree_surface(testing::moved(mesh, turn, shift, scale));
        Random random(7);
        int tried = 0;
        for (const Coefficients mu : {Coefficients{0.05, 0.02}, {0.4, 0.3}, {1.2, 0.0}, {2.0, 2.0}}) {
          const auto renderer = cone(world, kStiffness / scale, mu, radius * scale);
          Hand hand(*renderer);
          StepResult held = hand.to(turn * (scale * tips[0]) + shift);
          for (std::size_t i = 1; i < tips.size(); ++i) {
            held = hand.to(turn * (scale * tips[i]) + shift);
            // Near the face's middle, so that the way out of the cone does not lead over an edge.
            if (!held.contact || i % 20 != 0) continue;
            const Vec3 n = held.n_W;
            const Vec3 t = n.cross(random.direction()).normalized();
            const double h = 2e-4 * scale;
            const auto at = [&](double of_break_away) {
              return Vec3(held.contact_W_m - h * n + of_break_away * mu.mu_static * h * t);
            };
            // Straight below the contact point it comes to rest, and is held from then on.
            const double rounding = 64 * kEps * 0.1 * scale;
            const StepResult rest = hand.to(at(0.0));
            ASSERT_LE((rest.contact_W_m - held.contact_W_m).norm(), rounding) << name << " x " << scale;
            const StepResult below = hand.to(at(0.0));
            ASSERT_EQ(below.contact_W_m, rest.contact_W_m) << name << " x " << scale;
            if (!(below.n_W.dot(n) > 1.0 - 1e-12)) continue;  // at an edge there are several normals
            const StepResult just_held = hand.to(at(1.0 - 1e-8));
            ASSERT_EQ(just_held.contact_W_m, rest.contact_W_m) << name << " x " << scale << " step " << i;
            if (!(just_held.n_W.dot(n) > 1.0 - 1e-12)) continue;
            const Split before = split(just_held);
            ++tried;
            EXPECT_NEAR(before.tangential_N / before.normal_N, mu.mu_static, 1e-7 * mu.mu_static) << name;
            const StepResult gone = hand.to(at(1.0 + 1e-8));
            const Split after = split(gone);
            ASSERT_NE(gone.contact_W_m, rest.contact_W_m) << name << " x " << scale << " step " << i;
            ASSERT_LE(after.tangential_N, mu.mu_dynamic * after.normal_N * (1.0 + 1e-9) + kStiffness * 1e3 * kEps * 0.1)
                << name << " x " << scale << " step " << i;
          }
        }
        EXPECT_GE(tried, 8) << name << " x " << scale;
      }
    }
  }
}

TEST(FrictionCone, TheForceStaysInTheConeAndTheSpringOnlyRelaxes) {
  for (const double radius : {0.0, 0.001}) {
    for (const auto& [name, mesh] : shapes()) {
      const auto surface = make_embree_surface(mesh);
      const auto tips = strokes(*surface, radius, 12, 1500);
      for (const Coefficients mu : {Coefficients{0.1, 0.1}, {0.5, 0.3}, {0.8, 0.2}}) {
        const auto renderer = cone(mesh, kStiffness, mu, radius);
        Hand hand(*renderer);
        const double rounding_m = 1e3 * kEps * 0.1;
        StepResult last;
        int slid = 0;
        int held = 0;
        for (std::size_t i = 0; i < tips.size(); ++i) {
          const StepResult now = hand.to(tips[i]);
          if (now.contact && last.contact) {
            const Split force = split(now);
            const bool same = now.contact_W_m == last.contact_W_m;
            (same ? held : slid) += 1;
            const double limit = (same ? mu.mu_static : mu.mu_dynamic) * force.normal_N;
            ASSERT_LE(force.tangential_N, limit * (1.0 + 1e-9) + kStiffness * rounding_m)
                << name << " radius " << radius << " mu " << mu.mu_static << " step " << i;
            // What the hand stored in the spring is at most kept.
            ASSERT_LE((now.contact_W_m - tips[i]).norm(),
                      (last.contact_W_m - tips[i]).norm() * (1.0 + 1e-9) + rounding_m)
                << name << " radius " << radius << " mu " << mu.mu_static << " step " << i;
          }
          last = now;
        }
        EXPECT_GT(slid, 20) << name << " radius " << radius << " mu " << mu.mu_static;
        EXPECT_GT(held, 20) << name << " radius " << radius << " mu " << mu.mu_static;
      }
    }
  }
}

TEST(FrictionCone, WithoutFrictionIsTheGodObjectToTheBit) {
  for (const double radius : {0.0, 0.001}) {
    for (const auto& [name, mesh] : shapes()) {
      const auto surface = make_embree_surface(mesh);
      const auto plain = god_object(mesh, kStiffness, radius);
      const auto zero = cone(mesh, kStiffness, {0.0, 0.0}, radius);
      Hand one(*plain);
      Hand other(*zero);
      for (const Vec3& p : strokes(*surface, radius, 13, 1000)) {
        const StepResult expected = one.to(p);
        const StepResult obtained = other.to(p);
        ASSERT_EQ(obtained.f_W_N, expected.f_W_N) << name;
        ASSERT_EQ(obtained.contact_W_m, expected.contact_W_m) << name;
        ASSERT_EQ(obtained.n_W, expected.n_W) << name;
        ASSERT_EQ(obtained.depth_m, expected.depth_m) << name;
      }
    }
  }
}

TEST(FrictionCone, DissipatesForceTimesWayOnAPlane) {
  for (const double scale : unit_scales()) {
    const TriangleMesh mesh =
        testing::moved(synthetic::make_mesh("plane", {}, 200).mesh, Quat::Identity(), Vec3::Zero(), scale);
    const auto renderer = cone(mesh, kStiffness / scale, {0.5, 0.3});
    Hand hand(*renderer);
    const double h = 1e-3 * scale;
    const double x = 0.5 * h;  // break-away
    hand.to({0, 0, h});
    hand.to({0, 0, -h});
    double given_J = 0.0;
    double last_x = 0.0;
    for (int i = 1; i <= 1000; ++i) {
      const Vec3 p(x + 1e-5 * scale * i, 0, -h);
      const StepResult now = hand.to(p);
      ASSERT_NEAR(now.f_W_N.x(), -0.3 * kStiffness / scale * h, 1e-10);
      given_J += now.f_W_N.x() * (p.x() - last_x);
      last_x = p.x();
    }
    EXPECT_NEAR(given_J, -0.3 * kStiffness / scale * h * last_x, 1e-9 * std::abs(given_J));
  }
}

// effects/friction.h: the same law beside a frictionless god-object.
TEST(FrictionCone, IsTheEffectCoulombFrictionOnAPlaneAtConstantDepth) {
  const TriangleMesh mesh = synthetic::make_mesh("plane", {}, 200).mesh;
  const double h = 8e-4;
  const auto effect = [&](Coefficients mu) {
    Model model = model_of("god-object", {{"stiffness_N_per_m", kStiffness}});
    model.effects.push_back(
        {"coulomb-friction",
         {{"mu_static", mu.mu_static}, {"mu_dynamic", mu.mu_dynamic}, {"presliding_m", mu.mu_static * h}},
         "/effects/0"});
    return make_renderer(model, make_embree_surface(mesh));
  };
  const auto compare = [&](Coefficients mu, const std::vector<Vec3>& tips) {
    const auto inside = cone(mesh, kStiffness, mu);
    const auto beside = effect(mu);
    Hand one(*inside);
    Hand other(*beside);
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const Vec3 obtained = one.to(tips[i]).f_W_N;
      const Vec3 expected = other.to(tips[i]).f_W_N;
      ASSERT_LE((obtained - expected).norm(), kStiffness * 1e4 * kEps * 0.05) << "step " << i << ", " << mu.mu_static;
    }
  };
  // Any path where both coefficients are the same.
  Random random(14);
  std::vector<Vec3> wander{{0, 0, h}, {0, 0, -h}};
  for (int i = 0; i < 3000; ++i) {
    const Vec3 d = 1e-4 * random.direction();
    wander.push_back(
        {std::clamp(wander.back().x() + d.x(), -0.03, 0.03), std::clamp(wander.back().y() + d.y(), -0.03, 0.03), -h});
  }
  compare({0.4, 0.4}, wander);
  // To and fro along a line where they differ.
  std::vector<Vec3> line{{0, 0, h}, {0, 0, -h}};
  for (int i = 1; i < 3000; ++i) line.push_back({0.01 * std::sin(0.003 * i), 0.006 * std::sin(0.003 * i), -h});
  compare({0.5, 0.3}, line);
}

TEST(FrictionCone, RefusesStaticBelowDynamicWithTheReason) {
  const auto surface = make_embree_surface(testing::cube(0.02));
  for (const std::string name : {"friction-cone", "force-shading"}) {
    try {
      make_renderer(parse_model(R"({"schema": "touchstone-model/1", "renderer": ")" + name +
                                    R"(", "parameters": {"mu_static": 0.2, "mu_dynamic": 0.3}})",
                                "m.json"),
                    surface);
      FAIL() << name;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("m.json: /parameters"),
                                                 ::testing::HasSubstr("mu_static 0.2 is below mu_dynamic 0.3")));
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
