// Friction inside the proxy's step: exact cases at every unit, invariants on every kind of surface.
#include "renderers/proxy/friction_cone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/surface/triangle_queries.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::TriangleMesh;

namespace {

constexpr double wall_stiffness = 500.0;
constexpr double eps = std::numeric_limits<double>::epsilon();

struct Coefficients {
  double mu_static, mu_dynamic;
};

std::unique_ptr<rendering::Renderer> cone(std::shared_ptr<const surface::Surface> surface, double stiffness,
                                          Coefficients mu, double radius_m = 0.0) {
  return make_renderer(model_of("friction-cone", {{"stiffness_N_per_m", stiffness},
                                                  {"mu_static", mu.mu_static},
                                                  {"mu_dynamic", mu.mu_dynamic},
                                                  {"tip_radius_m", radius_m}}),
                       std::move(surface));
}
std::unique_ptr<rendering::Renderer> cone(const TriangleMesh& mesh, double stiffness, Coefficients mu,
                                          double radius_m = 0.0) {
  return cone(make_embree_surface(mesh), stiffness, mu, radius_m);
}

struct Split {
  double normal_N, tangential_N;
};

Split split(const StepResult& step) {
  const double normal_N = step.f_W_N.dot(step.n_W);
  return {normal_N, (step.f_W_N - normal_N * step.n_W).norm()};
}

// Of the resultant N = sum l_i n_i, at most how much sum l_i is: |N| / min n_i . N over all triangles that it touches.
double most_pressed(const TriangleMesh& mesh, double radius_m, const StepResult& step) {
  double least = 1.0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) { return mesh.vertices_W_m[static_cast<std::size_t>(t[i])]; };
    const Vec3 n = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    const surface::TriangleClosest foot =
        surface::closest_on_triangle({corner(0), corner(1), corner(2)}, n, step.contact_W_m);
    if (std::sqrt(foot.squared_distance) > radius_m + 1e-9) continue;
    const Vec3 way = radius_m > 0.0 ? Vec3(-foot.from_query.normalized()) : n;
    if (const double cosine = way.dot(step.n_W); cosine > 0.0) least = std::min(least, cosine);
  }
  return 1.0 / least;
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
      surface::moved(testing::cube(0.015), Quat(0.9, 0.1, 0.3, 0.2).normalized(), Vec3(0.01, 0.004, 0.012));
  const auto shift = static_cast<std::int32_t>(crossed.vertices_W_m.size());
  crossed.vertices_W_m.insert(crossed.vertices_W_m.end(), other.vertices_W_m.begin(), other.vertices_W_m.end());
  for (auto t : other.triangles) crossed.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return {made("plane", 200),    made("sphere", 800),    {"coarse sphere", testing::ball(0.03, 1)},
          made("bumpy", 1000),   made("torus", 800),     made("saddle", 600),
          made("v-groove", 100), made("extrusion", 100), {"cubes that cross", crossed},
          made("gauss", 500)};
}

// Strokes that press up to 1 mm deep over a shape, with taps into the air, all in the shape's own unit.
std::vector<Vec3> strokes(const surface::Surface& at, double radius_m, std::uint64_t seed, int steps) {
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
    const surface::SurfacePoint foot = at.closest(from);
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
        const auto world = make_embree_surface(surface::moved(mesh, turn, shift, scale));
        Random random(7);
        int tried = 0;
        for (const Coefficients mu : {Coefficients{0.05, 0.02}, {0.4, 0.3}, {1.2, 0.0}, {2.0, 2.0}}) {
          const auto renderer = cone(world, wall_stiffness / scale, mu, radius * scale);
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
            const double rounding = 64 * eps * 0.1 * scale;
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
            ASSERT_LE(after.tangential_N,
                      mu.mu_dynamic * after.normal_N * (1.0 + 1e-9) + wall_stiffness * 1e3 * eps * 0.1)
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
        const auto renderer = cone(mesh, wall_stiffness, mu, radius);
        Hand hand(*renderer);
        const double rounding_m = 1e3 * eps * 0.1;
        StepResult last;
        int slid = 0;
        int held = 0;
        for (std::size_t i = 0; i < tips.size(); ++i) {
          const StepResult now = hand.to(tips[i]);
          if (now.contact && last.contact) {
            const Split force = split(now);
            const bool same = now.contact_W_m == last.contact_W_m;
            (same ? held : slid) += 1;
            const double pressed_N = force.normal_N * most_pressed(mesh, radius, now);
            const double limit = (same ? mu.mu_static : mu.mu_dynamic) * pressed_N;
            ASSERT_LE(force.tangential_N, limit * (1.0 + 1e-9) + wall_stiffness * rounding_m)
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
      const auto plain = god_object(mesh, wall_stiffness, radius);
      const auto zero = cone(mesh, wall_stiffness, {0.0, 0.0}, radius);
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

// Coulomb's law at each wall. Across the groove the walls' forces l_1 and l_2 balance the pull; along it each gives mu
// of its own. Unequal slopes a and b and a pull that leans by c from the vertical, between both normals: by the law of
// sines l_1 = N sin(b + c) / sin(a + b), l_2 = N sin(a - c) / sin(a + b). Wall 1 rises to the left, its normal leans
// right.
TEST(FrictionCone, AlongAGrooveBothWallsRub) {
  struct Groove {
    double left, right, lean;  // degrees
  };
  for (const Groove& groove : {Groove{45, 45, 0}, {20, 20, 0}, {70, 70, 0}, {30, 60, 10}, {80, 15, -12}, {3, 5, 1}}) {
    const auto radians = [](double degrees) { return degrees * std::acos(-1.0) / 180.0; };
    const double a = radians(groove.left);
    const double b = radians(groove.right);
    const double c = radians(groove.lean);
    const double of_resultant = (std::sin(b + c) + std::sin(a - c)) / std::sin(a + b);
    for (const double scale : unit_scales()) {
      TriangleMesh mesh;
      const double half = 0.04;
      mesh.vertices_W_m = {{-half * std::cos(a), -half, half * std::sin(a)},
                           {-half * std::cos(a), half, half * std::sin(a)},
                           {0, -half, 0},
                           {0, half, 0},
                           {half * std::cos(b), -half, half * std::sin(b)},
                           {half * std::cos(b), half, half * std::sin(b)}};
      mesh.triangles = {{0, 2, 1}, {2, 3, 1}, {2, 4, 3}, {4, 5, 3}};
      const Quat turn = awkward_rotation();
      const auto world = make_embree_surface(surface::moved(mesh, turn, Vec3::Zero(), scale));
      for (const double radius : {0.0, 0.002}) {
        const Coefficients mu{0.4, 0.3};
        const auto renderer = cone(world, wall_stiffness / scale, mu, radius * scale);
        Hand hand(*renderer);
        const double depth = 1e-3;
        // Where the ball's centre rests: its distance from both walls is the radius.
        const double away = radius / std::sin((std::acos(-1.0) - a - b) / 2.0);
        const double middle = (a - b) / 2.0;
        const Vec3 line(away * std::sin(middle), 0.0, away * std::cos(middle));
        const auto at = [&](double y, double d) {
          return Vec3(turn * (scale * (line + Vec3(-d * std::sin(c), y, -d * std::cos(c)))));
        };
        // Onto both walls: the ball from the air, the point as a run that starts inside. From the air it would be held
        // where it comes through one of them.
        if (radius > 0.0) hand.to(at(0.0, -depth));
        hand.to(at(0.0, depth));
        const StepResult rest = hand.to(at(0.0, depth));
        const double limit_m = of_resultant * depth;
        const StepResult held = hand.to(at(mu.mu_static * limit_m * (1.0 - 1e-6), depth));
        EXPECT_LE((held.contact_W_m - rest.contact_W_m).norm(), 1e-9 * depth * scale) << groove.left << " x " << scale;
        for (const double y : {mu.mu_static * limit_m * (1.0 + 1e-6), 0.002, 0.005, 0.011}) {
          const Vec3 force = turn.conjugate() * hand.to(at(y, depth)).f_W_N;
          EXPECT_NEAR(force.y(), -mu.mu_dynamic * of_resultant * wall_stiffness * depth, 1e-9 * wall_stiffness * depth)
              << groove.left << " and " << groove.right << " leaning " << groove.lean << " radius " << radius << " x "
              << scale << " y " << y;
          EXPECT_NEAR(std::hypot(force.x(), force.z()), wall_stiffness * depth, 1e-9 * wall_stiffness * depth);
        }
      }
    }
  }
}

TEST(FrictionCone, DissipatesForceTimesWayOnAPlane) {
  for (const double scale : unit_scales()) {
    const TriangleMesh mesh =
        surface::moved(synthetic::make_mesh("plane", {}, 200).mesh, Quat::Identity(), Vec3::Zero(), scale);
    const auto renderer = cone(mesh, wall_stiffness / scale, {0.5, 0.3});
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
      ASSERT_NEAR(now.f_W_N.x(), -0.3 * wall_stiffness / scale * h, 1e-10);
      given_J += now.f_W_N.x() * (p.x() - last_x);
      last_x = p.x();
    }
    EXPECT_NEAR(given_J, -0.3 * wall_stiffness / scale * h * last_x, 1e-9 * std::abs(given_J));
  }
}

// effects/friction.h: the same law beside a frictionless god-object.
TEST(FrictionCone, IsTheEffectCoulombFrictionOnAPlaneAtConstantDepth) {
  const TriangleMesh mesh = synthetic::make_mesh("plane", {}, 200).mesh;
  const double h = 8e-4;
  const auto effect = [&](Coefficients mu) {
    rendering::Model model = model_of("god-object", {{"stiffness_N_per_m", wall_stiffness}});
    model.effects.push_back(
        {"coulomb-friction",
         {{"mu_static", mu.mu_static}, {"mu_dynamic", mu.mu_dynamic}, {"presliding_m", mu.mu_static * h}},
         "/effects/0"});
    return make_renderer(model, make_embree_surface(mesh));
  };
  const auto compare = [&](Coefficients mu, const std::vector<Vec3>& tips) {
    const auto inside = cone(mesh, wall_stiffness, mu);
    const auto beside = effect(mu);
    Hand one(*inside);
    Hand other(*beside);
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const Vec3 obtained = one.to(tips[i]).f_W_N;
      const Vec3 expected = other.to(tips[i]).f_W_N;
      ASSERT_LE((obtained - expected).norm(), wall_stiffness * 1e4 * eps * 0.05)
          << "step " << i << ", " << mu.mu_static;
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
      make_renderer(rendering::parse_model(R"({"schema": "touchstone-model/1", "renderer": ")" + name +
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

// The same law on two planes that meet at x = 0, slowly and in 64 bits of mantissa: the god-object of a ball in the
// wedge above both, held by the cones of the planes that press, or sent by bisection to the goal where the tip lies on
// the cone.
class WedgeTwin {
 public:
  using Long = long double;
  using LongVec = Eigen::Matrix<Long, 3, 1>;

  // The second plane rises over x > 0 through the point `rise`.
  WedgeTwin(const Vec3& rise, double radius_m, Coefficients mu)
      : normals_{LongVec(0, 0, 1), LongVec(-rise.z(), 0, rise.x()).normalized()}, radius_m_(radius_m), mu_(mu) {}

  LongVec start(const Vec3& p) { return g_ = rest(p.cast<Long>()); }
  LongVec follow(const Vec3& tip) {
    const LongVec p = tip.cast<Long>();
    const auto [slide, pressed] = split(p);
    const bool holds = slide.norm() <= (sliding_ ? mu_.mu_dynamic : mu_.mu_static) * pressed;
    sliding_ = !holds;
    if (holds) return g_;
    Long inside = 0;
    Long outside = 1;
    for (int i = 0; i < 200; ++i) {
      const Long share = (inside + outside) / 2;
      g_ = rest(p - share * slide);
      const auto [now_slide, now_pressed] = split(p);
      (now_slide.norm() < mu_.mu_dynamic * now_pressed ? inside : outside) = share;
    }
    // Where the god-object jumps into the crease no goal puts the tip on the cone: the side that is inside of it. Which
    // planes hold it there decides where the next step slides.
    return g_ = rest(p - inside * slide);
  }
  [[nodiscard]] bool in_the_crease() const { return held_[0] && held_[1]; }

 private:
  [[nodiscard]] Long gap(int i, const LongVec& x) const { return normals_[i].dot(x) - radius_m_; }
  // The nearest place to q in the wedge; remembers which planes hold it.
  LongVec rest(const LongVec& q) {
    held_ = {false, false};
    if (gap(0, q) >= 0 && gap(1, q) >= 0) return q;
    for (const int i : {0, 1}) {
      LongVec x = q - gap(i, q) * normals_[i];
      held_ = {i == 0, i == 1};
      if (gap(i, q) <= 0 && gap(1 - i, x) >= 0) return x;
    }
    held_ = {true, true};
    // On the line where both planes, raised by the radius, meet: x and z alone.
    const Long tilt = -normals_[1].x();
    return {(normals_[1].z() - 1) * radius_m_ / tilt, q.y(), radius_m_};
  }
  // The pull on g along the surface, and what the planes press, each by itself, added.
  [[nodiscard]] std::pair<LongVec, Long> split(const LongVec& p) const {
    const LongVec way = p - g_;
    for (const int i : {0, 1}) {
      if (!held_[i] || normals_[i].dot(way) >= 0) continue;
      const LongVec slide = way - normals_[i].dot(way) * normals_[i];
      if (!held_[1 - i] || normals_[1 - i].dot(slide) >= 0) return {slide, (slide - way).norm()};
    }
    // The second plane alone presses across the crease, both upwards.
    const Long second = way.x() / -normals_[1].x();
    return {LongVec(0, way.y(), 0), second - way.z() - second * normals_[1].z()};
  }

  std::array<LongVec, 2> normals_;
  Long radius_m_;
  Coefficients mu_;
  LongVec g_ = LongVec::Zero();
  std::array<bool, 2> held_{};
  bool sliding_ = false;
};

// Where one plane presses, to 2e-9 of the force. Where both do, the place across the crease is as uncertain as what
// counts as touching (32 roundings of the mesh's size) over the bend: 0.14 nm for a millionth of a radian.
TEST(FrictionCone, InACreaseItIsThatOfTwoPlanes) {
  const Coefficients mu{0.4, 0.3};
  for (const double bend : {1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 1e-2, 3e-2, 1e-1}) {
    for (const double radius_m : {2e-4, 1e-3}) {
      const double height = 0.02 * std::sin(bend);
      const double far = 0.02 * std::cos(bend);
      TriangleMesh crease;
      crease.vertices_W_m = {{-0.02, -0.02, 0}, {-0.02, 0.02, 0},     {0, -0.02, 0},
                             {0, 0.02, 0},      {far, -0.02, height}, {far, 0.02, height}};
      crease.triangles = {{0, 2, 1}, {2, 3, 1}, {2, 4, 3}, {4, 5, 3}};
      const auto renderer = cone(crease, wall_stiffness, mu, radius_m);
      Hand hand(*renderer);
      WedgeTwin twin({far, 0, height}, radius_m, mu);
      const auto expect = [&](const Vec3& p, const StepResult& step, const WedgeTwin::LongVec& center) {
        const Vec3 force = (wall_stiffness * (center - p.cast<long double>())).cast<double>();
        const double across_N = twin.in_the_crease() ? wall_stiffness * 32.0 * eps * 0.02 / bend : 0.0;
        ASSERT_LE((step.f_W_N - force).norm(), 2e-9 * force.norm() + across_N)
            << "bend " << bend << " radius " << radius_m << " tip " << p.transpose();
      };
      const double depth = 1e-3;
      const Vec3 begin(-0.003, -0.001, -depth);
      expect(begin, hand.to(begin), twin.start(begin));
      Vec3 at = begin;
      // Past the crease and back, along it and over it, and straight over it at x = 0.
      for (const Vec3& end :
           {Vec3(0.003, 0.001, -depth), Vec3(-0.003, 0.001, -depth), Vec3(0.0, 0.003, -depth),
            Vec3(0.0, -0.003, -depth), Vec3(1e-9, 0.003, -depth), Vec3(0.002, -0.002, -2.0 * depth)}) {
        static constexpr int step_count = 120;
        const Vec3 from = at;
        for (int i = 1; i <= step_count; ++i) {
          const Vec3 p = from + (end - from) * i / step_count;
          expect(p, hand.to(p), twin.follow(p));
          if (HasFatalFailure()) return;
        }
        at = end;
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
