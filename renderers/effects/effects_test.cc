// Each law against its formula on a plane, where depth, normal and path are what the test makes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/rendering/effect_stack.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "renderers/effects/catalogue.h"
#include "synthetic/surfaces/sphere.h"

namespace touchstone::renderers {
using rendering::Model;
using rendering::StepResult;

namespace {

constexpr double k = 800.0;

// A square in z = 0, `half` metres to each side.
std::shared_ptr<const surface::Surface> square(double half) {
  surface::TriangleMesh mesh;
  mesh.vertices_W_m = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.source = "square";
  return make_embree_surface(mesh);
}

Model with(const std::string& effect, std::map<std::string, double> parameters, double stiffness = k) {
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = stiffness;
  model.effects = {{effect, std::move(parameters), "/effects/0"}};
  model.source = "test";
  return model;
}

// Runs the path (one sample each `dt` seconds) and returns the results.
std::vector<StepResult> run(const Model& model, const std::vector<Vec3>& path, double dt, double half = 1.0) {
  const auto renderer = make_renderer(model, square(half));
  renderer->reset();
  std::vector<StepResult> results;
  for (std::size_t i = 0; i < path.size(); ++i) {
    results.push_back(renderer->step({static_cast<double>(i) * dt, path[i], Quat::Identity()}));
    EXPECT_EQ(results.back().status, rendering::StepStatus::ok);
  }
  return results;
}

TEST(Effects, WithoutEffectsTheOutputIsTheBasesToTheBit) {
  Model plain = with("coulomb-friction", {});
  plain.effects.clear();
  const Model inert = with("coulomb-friction", {{"mu_static", 0.0}, {"mu_dynamic", 0.0}});
  std::vector<Vec3> path;
  for (int i = 0; i < 200; ++i) path.emplace_back(1e-3 * i, 3e-4 * i, 0.01 - 1e-4 * i);
  const auto a = run(plain, path, 1e-3);
  const auto b = run(inert, path, 1e-3);
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(a[i].f_W_N.z(), b[i].f_W_N.z());
    EXPECT_EQ(b[i].f_W_N.x(), 0.0);
  }
}

class FrictionAtScale : public ::testing::TestWithParam<double> {};

// Down, along x, back, and along y: at every unit of length the same friction.
TEST_P(FrictionAtScale, StaysInTheConeOpposesMotionAndBreaksAwayAtItsCoefficient) {
  const double scale = GetParam();
  const double mu_static = 0.5;
  const double mu_dynamic = 0.3;
  const double presliding = 1e-4 * scale;
  const Model model =
      with("coulomb-friction", {{"mu_static", mu_static}, {"mu_dynamic", mu_dynamic}, {"presliding_m", presliding}},
           k / scale);
  std::vector<Vec3> path{{0, 0, 1e-3 * scale}};
  for (int i = 0; i <= 100; ++i) path.emplace_back(1e-5 * i * scale, 0.0, -1e-3 * scale);
  for (int i = 0; i <= 100; ++i) path.emplace_back(1e-3 * scale - 1e-5 * i * scale, 0.0, -1e-3 * scale);
  const auto results = run(model, path, 1e-3, scale);
  const double N = k * 1e-3;
  double largest = 0.0;
  double work = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double f_t = results[i].f_W_N.head<2>().norm();
    EXPECT_LE(f_t, mu_static * N * (1.0 + 1e-12));
    largest = std::max(largest, f_t);
    work += results[i].f_W_N.head<2>().dot((path[i] - path[i - 1]).head<2>());
  }
  // Break-away: stuck until the pre-sliding path is used up, with the force in proportion to it.
  EXPECT_NEAR(results[1 + 5].f_W_N.x(), -mu_static * N * 0.5, 1e-9);
  EXPECT_GT(largest, 0.89 * mu_static * N);
  EXPECT_NEAR(results[100].f_W_N.x(), -mu_dynamic * N, 1e-9);   // sliding towards +x
  EXPECT_NEAR(results.back().f_W_N.x(), mu_dynamic * N, 1e-9);  // sliding back
  EXPECT_LT(work, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Units, FrictionAtScale, ::testing::Values(1e-3, 1.0, 1e3));

TEST(Effects, StribeckFallsWithSpeed) {
  const double v_s = 0.02;
  const double presliding = 1e-6;
  const Model model =
      with("stribeck-friction",
           {{"mu_static", 0.6}, {"mu_dynamic", 0.2}, {"stribeck_velocity_m_per_s", v_s}, {"presliding_m", presliding}});
  for (const double v : {0.005, 0.02, 0.1}) {
    std::vector<Vec3> path;
    for (int i = 0; i < 60; ++i) path.emplace_back(v * 1e-3 * i, 0.0, -1e-3);
    const double mu = 0.2 + 0.4 * std::exp(-(v / v_s) * (v / v_s));
    EXPECT_NEAR(run(model, path, 1e-3).back().f_W_N.x(), -mu * k * 1e-3, 1e-9);
  }
}

TEST(Effects, AnisotropicFrictionHasItsOwnCoefficientAlongEachAxis) {
  const Model model = with("anisotropic-friction", {{"mu_x", 0.2}, {"mu_y", 0.6}, {"presliding_m", 1e-6}});
  for (const auto& [direction, mu] : {std::pair(Vec3(1, 0, 0), 0.2), std::pair(Vec3(0, 1, 0), 0.6)}) {
    std::vector<Vec3> path;
    for (int i = 0; i < 60; ++i) path.emplace_back(1e-5 * i * direction - Vec3(0, 0, 1e-3));
    EXPECT_NEAR(run(model, path, 1e-3).back().f_W_N.dot(direction), -mu * k * 1e-3, 1e-9);
  }
}

// Slid at three depths: twice the load has 2^(2/3) times the friction, and an exponent of 1 is Coulomb's law.
TEST(Effects, SublinearFrictionGoesWithAPowerOfTheLoad) {
  for (const double exponent : {2.0 / 3.0, 1.0}) {
    const Model model =
        with("sublinear-friction",
             {{"mu_reference", 0.4}, {"exponent", exponent}, {"reference_force_N", 0.8}, {"presliding_m", 1e-5}});
    for (const double depth_m : {5e-4, 1e-3, 2e-3}) {
      const auto results = run(model, {{0.0, 0.0, -depth_m}, {1e-3, 0.0, -depth_m}, {2e-3, 0.0, -depth_m}}, 1e-3);
      EXPECT_NEAR(results.back().f_W_N.x(), -0.4 * 0.8 * std::pow(k * depth_m / 0.8, exponent), 1e-9) << depth_m;
    }
  }
}

// Slid steadily the age is critical slip over speed; a rest of a time adds it to the age, and the force that it takes
// to slide again shows it.
TEST(Effects, AgeingFrictionFallsWithTheLogarithmOfSpeedAndGrowsWithARest) {
  constexpr double dt = 1e-3, slip_m = 1e-3, depth_m = 1e-3, reference_s = 0.02;
  const Model model = with("ageing-friction", {{"mu_fresh", 0.3},
                                               {"growth", 0.05},
                                               {"critical_slip_m", slip_m},
                                               {"reference_time_s", reference_s},
                                               {"presliding_m", 1e-6}});
  const auto limit_N = [&](double age_s) { return k * depth_m * (0.3 + 0.05 * std::log1p(age_s / reference_s)); };
  for (const double v : {2e-3, 2e-2}) {
    std::vector<Vec3> path;
    for (int i = 0; i * dt * v < 30.0 * slip_m; ++i) path.emplace_back(i * dt * v, 0.0, -depth_m);
    const auto slid = run(model, path, dt);
    EXPECT_NEAR(-slid.back().f_W_N.x(), limit_N(slip_m / v), 1e-6 * limit_N(0.0)) << v;
    for (const double rest_s : {0.1, 1.0}) {
      auto rested = path;
      rested.insert(rested.end(), static_cast<std::size_t>(std::lround(rest_s / dt)), path.back());
      rested.push_back(path.back() + Vec3(2e-6, 0.0, 0.0));  // hardly renews it, and is beyond the bristle
      EXPECT_NEAR(-run(model, rested, dt).back().f_W_N.x(), limit_N(slip_m / v + rest_s), 2e-3 * limit_N(0.0));
    }
  }
}

TEST(Effects, TwoMaterialsMeetAtABorder) {
  constexpr double border_m = 0.02, width_m = 2e-3, depth_m = 1e-3, ratio = 2.5;
  for (const double direction : {0.0, 0.7, -2.0}) {
    const Model model =
        with("two-materials",
             {{"ratio", ratio}, {"direction_rad", direction}, {"border_m", border_m}, {"width_m", width_m}});
    const Vec3 across(std::cos(direction), std::sin(direction), 0.0);
    const Vec3 along(-across.y(), across.x(), 0.0);
    const auto force_N = [&](double s_m) {
      return run(model, {s_m * across + 0.03 * along - depth_m * Vec3::UnitZ()}, 1e-3).back().f_W_N.z();
    };
    EXPECT_NEAR(force_N(border_m - 10.0 * width_m), k * depth_m, 1e-6);
    EXPECT_NEAR(force_N(border_m), std::sqrt(ratio) * k * depth_m, 1e-9);
    EXPECT_NEAR(force_N(border_m + 10.0 * width_m), ratio * k * depth_m, 1e-6);
  }
}

TEST(Effects, RatesAgainstTheirFormulas) {
  const double dt = 1e-3;
  const double v = 0.05;
  std::vector<Vec3> press;
  for (int i = 0; i < 40; ++i) press.emplace_back(0.1 * i * dt, 0.0, 1e-3 - v * i * dt);
  const double d = -press.back().z();
  EXPECT_NEAR(run(with("normal-damping", {{"coefficient_N_s_per_m", 7.0}}), press, dt).back().f_W_N.z(),
              k * d + 7.0 * v, 1e-9);
  EXPECT_NEAR(run(with("hunt-crossley", {{"coefficient_N_s_per_m2", 900.0}}), press, dt).back().f_W_N.z(),
              k * d + 900.0 * d * v, 1e-9);
  EXPECT_NEAR(run(with("viscous-friction", {{"coefficient_N_s_per_m", 3.0}}), press, dt).back().f_W_N.x(), -3.0 * 0.1,
              1e-9);
  EXPECT_NEAR(
      run(with("power-law-stiffness", {{"exponent", 1.5}, {"reference_depth_m", 1e-3}}), press, dt).back().f_W_N.z(),
      k * 1e-3 * std::pow(d / 1e-3, 1.5), 1e-9);
}

TEST(Effects, DampingNeverPulls) {
  std::vector<Vec3> leave;
  for (int i = 0; i < 40; ++i) leave.emplace_back(0.0, 0.0, -2e-3 + 0.5 * i * 1e-3);
  for (const StepResult& result : run(with("normal-damping", {{"coefficient_N_s_per_m", 50.0}}), leave, 1e-3)) {
    EXPECT_GE(result.f_W_N.z(), 0.0);
  }
}

TEST(Effects, AStiffnessMapIsAGaussianOverThePlace) {
  const Model model = with("stiffness-map", {{"amplitude", 0.5}, {"x_m", 0.1}, {"y_m", -0.2}, {"width_m", 0.05}});
  for (const double distance : {0.0, 0.05, 0.2}) {
    const auto results = run(model, {{0.1 + distance, -0.2, 1e-3}, {0.1 + distance, -0.2, -1e-3}}, 1e-3);
    const double factor = 1.0 + 0.5 * std::exp(-0.5 * distance * distance / (0.05 * 0.05));
    EXPECT_NEAR(results.back().f_W_N.z(), k * 1e-3 * factor, 1e-9);
  }
}

TEST(Effects, RelaxationDecaysToTheSpringAlone) {
  const double ratio = 0.4;
  const double tau = 0.1;
  std::vector<Vec3> hold(301, Vec3(0, 0, -2e-3));
  const auto results = run(with("stress-relaxation", {{"ratio", ratio}, {"time_constant_s", tau}}), hold, 1e-3);
  EXPECT_NEAR(results.front().f_W_N.z(), k * 2e-3 * (1.0 + ratio), 1e-9);
  EXPECT_NEAR(results[100].f_W_N.z(), k * 2e-3 * (1.0 + ratio * std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(results[300].f_W_N.z(), k * 2e-3 * (1.0 + ratio * std::exp(-3.0)), 1e-9);
}

// A tip that leaves faster than the surface comes back, and touches it again where it is by then. The twin is the
// network itself in steps of 1 us: spring k beside a spring ratio k in series with a damper, whose end y moves by
// y' = (u - y) / tau; without a tip k u + ratio k (u - y) = 0. Strokes end and begin between samples, at which the
// effect takes the surface's motion for steady: it is off by the part of a step of 1 ms times the arm's force.
TEST(Effects, ASurfaceThatRelaxesComesBackByItself) {
  const double ratio = 0.8;
  for (const double tau : {0.05, 0.4}) {
    const double speed = 0.02;  // m/s, up and down around the surface
    const auto height = [&](double t) { return -2e-3 * std::sin(2.0 * std::numbers::pi * speed / 8e-3 * t); };
    std::vector<Vec3> path;
    for (int i = 0; i <= 2000; ++i) path.emplace_back(0.0, 0.0, height(1e-3 * i));
    const auto results = run(with("stress-relaxation", {{"ratio", ratio}, {"time_constant_s", tau}}), path, 1e-3);
    double y = 0.0;
    int pressed = 0;
    int over_a_dent = 0;
    for (int i = 0; i <= 2000; ++i) {
      const double tip = -height(1e-3 * i);
      const double alone = ratio * y / (1.0 + ratio);
      const double force = tip > alone ? k * tip + ratio * k * (tip - y) : 0.0;
      EXPECT_NEAR(results[i].f_W_N.z(), force, 0.002 * ratio * k * 2e-3) << i << ", " << tau;
      pressed += force > 0.0 ? 1 : 0;
      over_a_dent += tip > 1e-4 && force == 0.0 ? 1 : 0;
      for (int j = 0; j < 1000; ++j) {
        const double deeper = std::max(-height(1e-3 * i + 1e-6 * j), ratio * y / (1.0 + ratio));
        y += 1e-6 * (deeper - y) / tau;
      }
    }
    EXPECT_GT(pressed, 500);
    EXPECT_GT(over_a_dent, 50);
  }
}

TEST(Effects, AdhesionHoldsOnlyAfterTouchAndUntilFiveRanges) {
  const Model model = with("adhesion", {{"force_N", 0.3}, {"range_m", 1e-3}});
  const std::vector<Vec3> path{{0, 0, 1e-3}, {0, 0, -1e-3}, {0, 0, 1e-3}, {0, 0, 4.9e-3}, {0, 0, 5.1e-3}, {0, 0, 1e-3}};
  const auto results = run(model, path, 1e-3);
  EXPECT_EQ(results[0].f_W_N.z(), 0.0);  // near, but never touched
  EXPECT_NEAR(results[1].f_W_N.z(), k * 1e-3 - 0.3, 1e-9);
  EXPECT_NEAR(results[2].f_W_N.z(), -0.3 * std::exp(-1.0), 1e-9);
  EXPECT_NEAR(results[3].f_W_N.z(), -0.3 * std::exp(-4.9), 1e-9);
  EXPECT_EQ(results[4].f_W_N.z(), 0.0);
  EXPECT_EQ(results[5].f_W_N.z(), 0.0);  // broken until touched again
}

TEST(Effects, TextureAddsItsWaveToTheDepthAndTouchesFirstAtItsCrests) {
  const Model model = with("surface-texture",
                           {{"amplitude_m", 1e-4}, {"wavelength_m", 0.01}, {"direction_rad", 0.0}, {"phase_rad", 0.0}});
  const auto results =
      run(model, {{0, 0, 1e-3}, {0.0025, 0, -1e-3}, {0.0075, 0, -1e-3}, {0.0025, 0, 5e-5}, {0.0075, 0, 5e-5}}, 1e-3);
  EXPECT_NEAR(results[1].f_W_N.z(), k * 1.1e-3, 1e-9);
  EXPECT_NEAR(results[2].f_W_N.z(), k * 0.9e-3, 1e-9);
  EXPECT_NEAR(results[3].f_W_N.z(), k * 5e-5, 1e-9);  // above the mesh, under the crest
  EXPECT_EQ(results[4].f_W_N.z(), 0.0);
}

// On a curved body a deeply pressed tip is not where its foot is: the texture is the surface's, so it counts at the
// foot.
TEST(Effects, TextureActsAtTheFootOnACurvedBody) {
  const double radius = 0.03, depth = 0.004, amplitude = 2e-4, wavelength = 0.005;
  const auto surface = std::make_shared<synthetic::Sphere>(radius);
  Model model =
      with("surface-texture",
           {{"amplitude_m", amplitude}, {"wavelength_m", wavelength}, {"direction_rad", 0.0}, {"phase_rad", 0.3}});
  model.renderer = "penalty";
  const auto renderer = make_renderer(model, surface);
  for (const double angle : {0.2, 0.5, 0.9, 1.3}) {
    const Vec3 n(std::sin(angle), 0.0, std::cos(angle));
    renderer->reset();
    const StepResult result = renderer->step({0.0, (radius - depth) * n, Quat::Identity()});
    const double height = amplitude * std::sin(2.0 * std::numbers::pi * radius * n.x() / wavelength + 0.3);
    EXPECT_NEAR(result.f_W_N.dot(n), k * (depth + height), 1e-9) << "at " << angle << " rad";
  }
}

TEST(Effects, WrongModelsAreRefusedWithTheirPlace) {
  const auto message = [](const Model& model) {
    try {
      make_renderer(model, square(1.0));
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(message(with("coulomb-friction", {{"mu_static", 0.2}, {"mu_dynamic", 0.3}})),
              ::testing::AllOf(::testing::HasSubstr("/effects/0"), ::testing::HasSubstr("below mu_dynamic")));
  EXPECT_THAT(message(with("coulomb-friction", {{"mu", 0.2}})), ::testing::HasSubstr("/effects/0/parameters/mu"));
  EXPECT_THAT(message(with("coulomb-frictoin", {})), ::testing::HasSubstr("coulomb-friction"));
  EXPECT_THAT(message(with("viscous-friction", {{"coefficient_N_s_per_m", -1.0}})),
              ::testing::HasSubstr("out of range"));
}

TEST(Effects, EveryEntrySaysWhereItComesFromAndWhyItIsPassive) {
  ASSERT_FALSE(contact_effects().empty());
  for (const EffectEntry& entry : contact_effects()) {
    EXPECT_FALSE(entry.source.empty()) << entry.name;
    EXPECT_FALSE(entry.passivity.empty()) << entry.name;
    EXPECT_FALSE(entry.parameters.empty()) << entry.name;
    EXPECT_TRUE(entry.make != nullptr || !entry.base_parameter.empty() || entry.takes_image) << entry.name;
  }
}

}  // namespace
}  // namespace touchstone::renderers
