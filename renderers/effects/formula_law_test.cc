// Declared effects against the same laws of the catalogue, against exact answers, and in the places where models run.
#include "renderers/effects/formula_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "harness/base/error.h"
#include "harness/rendering/measured_renderer.h"
#include "harness/rendering/model.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/allocation_guard.h"
#include "renderers/catalogue.h"
#include "renderers/measured.h"
#include "renderers/model_predictor.h"

namespace touchstone::renderers {
using rendering::DeclaredEffect;
using rendering::Model;

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::shared_ptr<const surface::Surface> plate() {
  surface::TriangleMesh mesh;
  mesh.vertices_W_m = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.source = "plate";
  return make_embree_surface(mesh);
}

// A model with one entry whose law has this text; `acts_on`, `body`: the rest of the file.
Model declared(const std::string& acts_on, const std::string& body, std::map<std::string, double> values,
               bool instrument = false) {
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = 800.0;
  model.source = "m.json";
  auto law = std::make_shared<const DeclaredEffect>(rendering::parse_effect(
      R"J({"schema": "touchstone-effect/1", "name": "mine", "summary": "s", "source": "s", "acts_on": ")J" + acts_on +
          "\", " + body + "}",
      "mine.json"));
  (instrument ? model.instrument : model.effects) = {{"mine", std::move(values), "/effects/0", {}, law}};
  return model;
}

Model built_in(const std::string& name, std::map<std::string, double> values) {
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = 800.0;
  model.effects = {{name, std::move(values), "/effects/0"}};
  return model;
}

// Down, in circles with a depth that goes up and down, off and on again.
MotionColumns circles() {
  MotionColumns motion;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.002 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(0.02 * std::sin(3.0 * t), 0.015 * std::cos(5.0 * t), 0.001 - 0.002 * std::sin(4.0 * t));
  }
  return motion;
}

std::vector<Vec3> forces(const Model& model, const MotionColumns& motion) {
  const auto renderer = make_renderer(model, plate());
  renderer->reset();
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < motion.size(); ++i)
    all.push_back(renderer->step({motion.t_s[i], motion.p_W_m[i], Quat::Identity()}).f_W_N);
  return all;
}

void expect_same(const Model& a, const Model& b) {
  const auto fa = forces(a, circles());
  const auto fb = forces(b, circles());
  double largest = 0.0;
  for (std::size_t i = 0; i < fa.size(); ++i) {
    ASSERT_LT((fa[i] - fb[i]).norm(), 1e-12 * (1.0 + fb[i].norm())) << "sample " << i;
    largest = std::max(largest, fb[i].norm());
  }
  EXPECT_GT(largest, 0.1);
}

TEST(FormulaEffect, DoesWhatTheCataloguesLawsDo) {
  const std::string b = R"J("parameters": {"b": {"unit": "N s/m", "minimum": 0, "maximum": 1e3, "start": 1}}, )J";
  expect_same(declared("friction", b + R"J("formula": {"along_N": "-b * speed_m_per_s"})J", {{"b", 7.0}}),
              built_in("viscous-friction", {{"coefficient_N_s_per_m", 7.0}}));
  expect_same(
      declared("friction", b + R"J("formula": {"x_N": "-b * vx_m_per_s", "y_N": "-b * vy_m_per_s"})J", {{"b", 7.0}}),
      built_in("viscous-friction", {{"coefficient_N_s_per_m", 7.0}}));
  expect_same(declared("normal-force", b + R"J("formula": {"normal_N": "b * depth_rate_m_per_s"})J", {{"b", 9.0}}),
              built_in("normal-damping", {{"coefficient_N_s_per_m", 9.0}}));
  expect_same(declared("stiffness",
                       R"J("parameters": {"n": {"unit": "1", "minimum": 0, "maximum": 5, "start": 1},
                                         "d0": {"unit": "m", "minimum": 1e-6, "maximum": 1, "start": 1e-3}},
                          "formula": {"factor": "(depth_m / d0)^(n - 1)"})J",
                       {{"n", 1.5}, {"d0", 2e-3}}),
              built_in("power-law-stiffness", {{"exponent", 1.5}, {"reference_depth_m", 2e-3}}));
}

TEST(FormulaEffect, DepthActsAcrossTheGap) {
  const auto model = declared("depth", R"J("parameters": {"h": {"unit": "m", "minimum": -1, "maximum": 1, "start": 0}},
                                          "formula": {"depth_m": "h"})J",
                              {{"h", 0.001}});
  const auto renderer = make_renderer(model, plate());
  renderer->reset();
  const rendering::StepResult step = renderer->step({0.0, {0.0, 0.0, 0.0004}, Quat::Identity()});
  EXPECT_TRUE(step.contact);
  EXPECT_NEAR(step.f_W_N.z(), 800.0 * 0.0006, 1e-9);
}

// x' = (target - x) / T from 0, target 1 N, is 1 - exp(-t/T); with steps of h the linearly implicit step leaves
// 1 - (1 + h/T)^-n, which tends to it and stays between 0 and 1 for steps far longer than T.
TEST(FormulaEffect, StatesFollowTheirRateAndStayStable) {
  for (const double T : {1.0, 0.05, 1e-5}) {
    const auto model = declared("normal-force",
                                R"J("parameters": {"a": {"unit": "N", "minimum": 0, "maximum": 9, "start": 1},
                                                  "T": {"unit": "s", "minimum": 1e-9, "maximum": 9, "start": 1}},
                                   "states": {"x": {"unit": "N", "rate": "(a - x) / T"}},
                                   "formula": {"normal_N": "x"})J",
                                {{"a", 1.0}, {"T", T}});
    const auto renderer = make_renderer(model, plate());
    renderer->reset();
    constexpr double h = 1e-3;
    double last = 0.0;
    for (int i = 0; i < 200; ++i) {
      last = renderer->step({h * i, {0.0, 0.0, -0.001}, Quat::Identity()}).f_W_N.z() - 0.8;
      EXPECT_NEAR(last, 1.0 - std::pow(1.0 + h / T, -i), 1e-6) << "T " << T << ", step " << i;
    }
    // Off and on again: the past is forgotten.
    renderer->step({0.3, {0.0, 0.0, 0.1}, Quat::Identity()});
    EXPECT_NEAR(renderer->step({0.301, {0.0, 0.0, -0.001}, Quat::Identity()}).f_W_N.z(), 0.8, 1e-12);
  }
}

// A law is read once and taken again: another thread has read none, so that its answers are those of one read anew.
TEST(FormulaEffect, ALawThatRanBeforeAnswersAsOneReadAnew) {
  const auto law = [](double b, double stuck) {
    return declared("friction",
                    R"J("parameters": {"b": {"unit": "N s/m", "minimum": 0, "maximum": 1e3, "start": 1},
                                       "l": {"unit": "m", "minimum": 1e-9, "maximum": 1, "start": 1e-3}},
                        "states": {"z": {"unit": "m", "start": 0.001, "rate": "vx_m_per_s - speed_m_per_s * z / l"}},
                        "formula": {"x_N": "-b * vx_m_per_s * z / l", "along_N": "-b * speed_m_per_s"})J",
                    {{"b", b}, {"l", stuck}});
  };
  const MotionColumns motion = circles();
  forces(law(3.0, 2e-3), motion);
  const Model other = law(7.0, 5e-4);
  const auto again = forces(other, motion);
  std::vector<Vec3> anew;
  std::thread([&] { anew = forces(other, motion); }).join();
  ASSERT_EQ(again.size(), anew.size());
  for (std::size_t i = 0; i < anew.size(); ++i) ASSERT_EQ(again[i], anew[i]) << i;
  // One that outlives what its thread keeps.
  std::thread([&] {
    static thread_local std::unique_ptr<rendering::Renderer> late;
    late = make_renderer(other, plate());
  }).join();
  // One that ends in another thread.
  std::unique_ptr<rendering::Renderer> made_elsewhere;
  std::thread([&] { made_elsewhere = make_renderer(other, plate()); }).join();
  made_elsewhere.reset();
  // Two that run at once are two.
  const auto one = make_renderer(other, plate());
  const auto two = make_renderer(law(1.0, 1e-3), plate());
  one->reset();
  two->reset();
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const rendering::TipState probe{motion.t_s[i], motion.p_W_m[i], Quat::Identity()};
    two->step(probe);
    ASSERT_EQ(one->step(probe).f_W_N, anew[i]) << i;
  }
}

TEST(FormulaEffect, AllocatesNothingInAStep) {
  if (!touchstone::testing::allocations_are_counted()) GTEST_SKIP() << "allocations are not counted in this build";
  const auto model = declared("friction",
                              R"J("parameters": {"mu": {"unit": "1", "minimum": 0, "maximum": 5, "start": 0.2},
                                                "s": {"unit": "m", "minimum": 1e-6, "maximum": 1, "start": 1e-3}},
                                 "states": {"z": {"unit": "m", "rate": "vx_m_per_s - abs(vx_m_per_s) * z / s"}},
                                 "formula": {"x_N": "-mu * normal_N * min(z / s, 1) * (depth_m > 0 ? 1 : 0)"})J",
                              {{"mu", 0.3}, {"s", 1e-3}});
  const auto renderer = make_renderer(model, plate());
  renderer->reset();
  const MotionColumns motion = circles();
  const touchstone::testing::AllocationGuard guard;
  for (std::size_t i = 0; i < motion.size(); ++i)
    (void)renderer->step({motion.t_s[i], motion.p_W_m[i], Quat::Identity()});
  EXPECT_EQ(guard.count(), 0U);
}

TEST(FormulaInstrument, AddsToTheReadingInItsFrame) {
  MotionColumns motion = circles();
  const Quat turned(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()));
  motion.q_WS.assign(motion.size(), turned);
  const std::string body = R"J("parameters": {"a": {"unit": "N", "minimum": 0, "maximum": 9, "start": 1},
                                             "f": {"unit": "Hz", "minimum": 0, "maximum": 99, "start": 1}},
                              "formula": {"x_N": "a * sin(2 * pi * f * t_s)"})J";
  for (const bool sensor : {true, false}) {
    const Model model = declared(sensor ? "sensor" : "tool", body, {{"a", 0.5}, {"f", 50.0}}, true);
    const auto predictor = make_model_predictor(plate(), motion);
    const rendering::Prediction with = predictor->predict(model);
    Model without = model;
    without.instrument.clear();
    const rendering::Prediction base = predictor->predict(without);
    const rendering::MeasuredRenderer measured = make_measured_renderer(model, plate());
    std::vector<Vec3> applied = base.f_W_N;
    measured.apply({motion.t_s, motion.p_W_m, motion.q_WS}, applied);
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const Vec3 added = (sensor ? Vec3(0, 1, 0) : Vec3(1, 0, 0)) * 0.5 * std::sin(2.0 * M_PI * 50.0 * motion.t_s[i]);
      EXPECT_LT((with.f_W_N[i] - base.f_W_N[i] - added).norm(), 1e-12);
      EXPECT_LT((applied[i] - with.f_W_N[i]).norm(), 1e-12);
    }
  }
}

TEST(FormulaEffect, RefusesParametersAndNamesLikeTheCatalogue) {
  const auto message = [](const Model& model) -> std::string {
    try {
      (void)make_renderer(model, plate());
    } catch (const BadData& error) {
      return error.what();
    }
    return "no error";
  };
  Model model = declared("normal-force",
                         R"J("parameters": {"a": {"unit": "N", "minimum": 0, "maximum": 9, "start": 1}},
                            "formula": {"normal_N": "a"})J",
                         {{"a", 10.0}});
  EXPECT_THAT(message(model), AllOf(HasSubstr("m.json: /effects/0/parameters/a"), HasSubstr("0 to 9 N")));
  model.effects[0].parameters = {{"b", 1.0}};
  EXPECT_THAT(message(model), HasSubstr("/effects/0/parameters/b"));
  model.effects[0].parameters.clear();
  EXPECT_EQ(message(model), "no error");
  DeclaredEffect same = *model.effects[0].law;
  same.name = "coulomb-friction";
  model.effects[0].name = same.name;
  model.effects[0].law = std::make_shared<const DeclaredEffect>(same);
  EXPECT_THAT(message(model), AllOf(HasSubstr("/effects/0/law"), HasSubstr("name of its own")));
}

}  // namespace
}  // namespace touchstone::renderers
