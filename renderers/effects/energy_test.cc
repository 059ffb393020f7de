// For every effect of the catalogue: a model with it removed is the base to the bit, and over a path that begins and
// ends in free air the contact gives no energy to the hand.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "harness/rendering/model.h"
#include "harness/rendering/smooth_field.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "renderers/effects/catalogue.h"

namespace touchstone::renderers {
using rendering::Model;
using rendering::TipState;

namespace {

// Parameters at which each effect is strong, for an object of one metre and forces of newtons.
std::map<std::string, double> strong(const std::string& name, double scale) {
  const std::map<std::string, std::map<std::string, double>> all{
      {"coulomb-friction", {{"mu_static", 0.6}, {"mu_dynamic", 0.4}, {"presliding_m", 1e-4 * scale}}},
      {"stribeck-friction",
       {{"mu_static", 0.6},
        {"mu_dynamic", 0.2},
        {"stribeck_velocity_m_per_s", 0.02 * scale},
        {"presliding_m", 1e-4 * scale}}},
      {"anisotropic-friction", {{"mu_x", 0.2}, {"mu_y", 0.6}, {"presliding_m", 1e-4 * scale}}},
      {"sublinear-friction",
       {{"mu_reference", 0.6}, {"exponent", 0.6}, {"reference_force_N", 0.5}, {"presliding_m", 1e-4 * scale}}},
      {"ageing-friction",
       {{"mu_fresh", 0.4},
        {"growth", 0.06},
        {"critical_slip_m", 2e-3 * scale},
        {"reference_time_s", 0.01},
        {"presliding_m", 1e-4 * scale}}},
      {"viscous-friction", {{"coefficient_N_s_per_m", 5.0 / scale}}},
      {"normal-damping", {{"coefficient_N_s_per_m", 8.0 / scale}}},
      {"hunt-crossley", {{"coefficient_N_s_per_m2", 2000.0 / (scale * scale)}}},
      {"power-law-stiffness", {{"exponent", 1.7}, {"reference_depth_m", 2e-3 * scale}}},
      {"stiffness-map", {{"amplitude", 1.0}, {"x_m", 0.0}, {"y_m", 0.0}, {"width_m", 0.02 * scale}}},
      {"two-materials", {{"ratio", 2.5}, {"direction_rad", 0.4}, {"border_m", 0.0}, {"width_m", 1e-3 * scale}}},
      {"stress-relaxation", {{"ratio", 0.7}, {"time_constant_s", 0.2}}},
      {"tip-radius", {{"radius_m", 3e-3 * scale}}},
      {"adhesion", {{"force_N", 0.4}, {"range_m", 5e-4 * scale}}},
      {"surface-texture",
       {{"amplitude_m", 2e-4 * scale}, {"wavelength_m", 0.01 * scale}, {"direction_rad", 0.4}, {"phase_rad", 0.3}}},
      {"magnet", {{"force_N", 0.5}, {"distance_m", 3e-3 * scale}, {"inside", 1.0}}},
      {"stick-slip", {{"stiffness_N_per_m", 200.0 / scale}, {"force_N", 0.6}}},
      {"viscosity", {{"coefficient_N_s_per_m", 5.0 / scale}}},
      {"height-image", {{"amplitude_m", 2e-4 * scale}, {"pixel_m", 4e-3 * scale}, {"x_m", 0.0}, {"y_m", 0.0}}},
  };
  if (name.ends_with("-field")) {
    std::map<std::string, double> values{{"x_low_m", -0.04 * scale}, {"y_low_m", -0.03 * scale},
                                         {"x_high_m", 0.04 * scale}, {"y_high_m", 0.03 * scale},
                                         {"columns", 6.0},           {"rows", 5.0}};
    for (std::size_t i = 0; i < 30; ++i)
      values[rendering::field_coefficient(i % 6, i / 6)] = 0.7 * std::sin(1.0 + 2.3 * static_cast<double>(i));
    return values;
  }
  return all.at(name);
}

struct Case {
  std::string effect;
  double scale;
};

class EveryEffect : public ::testing::TestWithParam<Case> {
 protected:
  static std::shared_ptr<const surface::Surface> square(double half) {
    surface::TriangleMesh mesh;
    mesh.vertices_W_m = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.source = "square";
    return make_embree_surface(mesh);
  }

  static Model model(const Case& c) {
    Model model;
    model.renderer = "god-object";
    model.parameters["stiffness_N_per_m"] = 800.0 / c.scale;
    model.effects = {{c.effect, strong(c.effect, c.scale), "/effects/0"}};
    // It scales what the friction before it makes.
    if (c.effect == "friction-field")
      model.effects.insert(model.effects.begin(),
                           {"coulomb-friction", strong("coulomb-friction", c.scale), "/effects/1"});
    model.source = "test";
    if (c.effect == "height-image") model.effects.front().image = hills();
    return model;
  }

  // A picture of smooth hills.
  static std::string hills() {
    static const std::string file = [] {
      const auto path = std::filesystem::path(::testing::TempDir()) / fmt::format("hills-{}.pgm", ::getpid());
      std::ofstream out(path);
      out << "P2\n16 16\n1000\n";
      for (int i = 0; i < 16; ++i) {
        for (int j = 0; j < 16; ++j)
          out << std::lround(500.0 +
                             400.0 * std::sin(std::numbers::pi * i / 8.0) * std::cos(std::numbers::pi * j / 8.0))
              << ' ';
        out << '\n';
      }
      return path.string();
    }();
    return file;
  }

  // Presses and strokes of several speeds at 20 kHz, from free air to free air; without strokes where `still`.
  static std::vector<TipState> path(double scale, bool still = false) {
    std::vector<TipState> tips;
    constexpr double dt = 5e-5;
    for (int i = 0; i <= 60000; ++i) {
      const double t = dt * i;
      const double s = t / 3.0;
      const double window = std::pow(std::sin(std::numbers::pi * s), 2);
      const double stroke = still ? 0.0 : 1.0;
      const Vec3 p(stroke * 0.03 * std::sin(7.0 * t + 9.0 * t * t), stroke * 0.02 * std::sin(11.0 * t),
                   0.008 - 0.02 * window * (0.6 + 0.4 * std::sin(15.0 * t + 6.0 * t * t)));
      tips.push_back({t, scale * p, Quat::Identity()});
    }
    return tips;
  }

  static std::vector<Vec3> forces(const Model& model, const std::vector<TipState>& tips, double scale) {
    const auto renderer = make_renderer(model, square(scale));
    renderer->reset();
    std::vector<Vec3> forces;
    for (const TipState& tip : tips) {
      const rendering::StepResult result = renderer->step(tip);
      EXPECT_EQ(result.status, rendering::StepStatus::ok);
      forces.push_back(result.f_W_N);
    }
    return forces;
  }
};

TEST_P(EveryEffect, RemovedGivesTheBaseBackToTheBit) {
  const auto tips = path(GetParam().scale);
  Model with = model(GetParam());
  Model base = with;
  base.effects.clear();
  const auto before = forces(base, tips, GetParam().scale);
  const auto strange = forces(with, tips, GetParam().scale);
  // Through the file, as a user would remove it.
  Model removed = rendering::parse_model(model_to_json(with), "test");
  removed.effects.clear();
  removed = rendering::parse_model(model_to_json(removed), "test");
  const auto after = forces(removed, tips, GetParam().scale);
  bool changed = false;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    ASSERT_EQ(before[i], after[i]) << "sample " << i;
    changed = changed || strange[i] != before[i];
  }
  EXPECT_TRUE(changed) << "the effect did nothing on this path";
}

TEST_P(EveryEffect, GivesNoEnergyOverAPathFromFreeAirToFreeAir) {
  // A stiffness map is a spring at each place, but no potential: its law has no force towards softer places, so that a
  // tip pushed in at a soft place and drawn out at a stiff one has gained. Its catalogue entry says so. So of a field.
  const bool still = GetParam().effect == "stiffness-map" || GetParam().effect == "stiffness-field";
  const auto tips = path(GetParam().scale, still);
  const auto f = forces(model(GetParam()), tips, GetParam().scale);
  ASSERT_TRUE(f.front().isZero());
  ASSERT_TRUE(f.back().isZero());
  double work = 0.0;     // on the hand, by the trapezium rule
  double traffic = 0.0;  // of energy to and fro
  for (std::size_t i = 1; i < f.size(); ++i) {
    const double step = 0.5 * (f[i] + f[i - 1]).dot(tips[i].p_W_m - tips[i - 1].p_W_m);
    work += step;
    traffic += std::abs(step);
  }
  // What sampling makes: steps in which the contact begins or ends, and rates half a step late.
  EXPECT_LT(work, 1e-3 * traffic);
  const std::vector<std::string> losing{"coulomb-friction",   "stribeck-friction", "anisotropic-friction",
                                        "sublinear-friction", "ageing-friction",   "viscous-friction",
                                        "normal-damping",     "hunt-crossley",     "stress-relaxation",
                                        "adhesion",           "stick-slip",        "viscosity"};
  if (std::find(losing.begin(), losing.end(), GetParam().effect) != losing.end()) {
    EXPECT_LT(work, -3e-3 * traffic);
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const EffectEntry& entry : contact_effects()) {
    for (const double scale : {1e-3, 1.0, 1e3}) all.push_back({std::string(entry.name), scale});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, ::testing::ValuesIn(cases()), [](const auto& parameter) {
  std::string name = parameter.param.effect + (parameter.param.scale < 1.0   ? "_mm"
                                               : parameter.param.scale > 1.0 ? "_km"
                                                                             : "_m");
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace touchstone::renderers
