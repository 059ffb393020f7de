// A renderer of several bodies behind version 2 of the plug-in interface gives the same bits as in the program: each
// body with its mesh, and its pose at each step.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "harness/base/error.h"
#include "harness/plugin/plugin.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/rendering/scene.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"

namespace touchstone::renderers {
using plugin::Plugins;
using rendering::BodyScene;
using rendering::StepResult;
using rendering::StepStatus;
using rendering::TipState;

namespace {

// A floor at rest, a block at rest elsewhere, and a ram that swings and turns over them.
std::shared_ptr<const BodyScene> scene_with_a_ram() {
  auto scene = std::make_shared<BodyScene>();
  scene->source = "test scene";
  scene->bodies.push_back({"floor", make_embree_surface(testing::grid(0.05, 6)), rendering::PoseTrack()});
  scene->bodies.push_back({"block", make_embree_surface(testing::cube(0.01)),
                           rendering::PoseTrack({{0.02, 0.0, 0.002}, Quat(Eigen::AngleAxisd(0.4, Vec3::UnitX()))})});
  MotionColumns ram;
  for (int i = 0; i <= 30; ++i) {
    const double t_s = 0.1 * i;
    ram.t_s.push_back(t_s);
    ram.p_W_m.emplace_back(-0.02 + 0.015 * std::sin(2.0 * t_s), 0.0, 0.003);
    ram.q_WS.emplace_back(Eigen::AngleAxisd(0.6 * t_s, Vec3::UnitZ()));
  }
  scene->bodies.push_back({"ram", make_embree_surface(testing::torus(0.012, 0.005, 16, 8)), {ram, "ram poses"}});
  return scene;
}

rendering::Model model_for(const std::string& name, const Plugins& plugins, std::map<std::string, double> parameters) {
  rendering::Model model = model_of(name, std::move(parameters));
  plugins.provide(model);
  return model;
}

Plugins loaded(bool in_process) {
  plugin::PluginOptions options;
  options.in_process = in_process;
  Plugins plugins;
  plugins.load(std::getenv("TOUCHSTONE_SCENE_TWIN_PLUGIN"), options, {});
  return plugins;
}

TEST(ScenePluginTwin, GivesTheSameBits) {
  const auto scene = scene_with_a_ram();
  const std::map<std::string, std::map<std::string, double>> runs{
      {"god-object", {{"stiffness_N_per_m", 600.0}}},
      {"friction-cone", {{"stiffness_N_per_m", 600.0}, {"mu_static", 0.5}, {"mu_dynamic", 0.3}}},
      {"force-shading", {{"stiffness_N_per_m", 600.0}, {"mu_static", 0.2}, {"mu_dynamic", 0.2}}}};
  for (const auto& [name, parameters] : runs) {
    for (const bool in_process : {true, false}) {
      const Plugins plugins = loaded(in_process);
      const auto own = make_scene_renderer(model_of(name, parameters), scene);
      const auto plugged = make_scene_renderer(model_for(name + "-scene-twin", plugins, parameters), scene);
      own->reset();
      plugged->reset();
      int touched = 0;
      for (int i = 0; i < 2000; ++i) {
        const double t_s = 1e-3 * (i + 1);
        const TipState tip{t_s,
                           {0.03 * std::sin(1.9 * t_s), 0.012 * std::cos(3.1 * t_s), 0.006 * std::cos(7.0 * t_s)},
                           Quat::Identity()};
        const StepResult expected = own->step(tip);
        const StepResult obtained = plugged->step(tip);
        ASSERT_EQ(obtained.status, StepStatus::ok) << plugged->failure();
        ASSERT_EQ(obtained.f_W_N, expected.f_W_N) << name << " " << i;
        ASSERT_EQ(obtained.contact_W_m, expected.contact_W_m) << name << " " << i;
        ASSERT_EQ(obtained.n_W, expected.n_W);
        ASSERT_EQ(obtained.depth_m, expected.depth_m);
        ASSERT_EQ(obtained.contact, expected.contact);
        touched += expected.contact ? 1 : 0;
      }
      EXPECT_GT(touched, 400) << name;
    }
  }
}

TEST(ScenePluginTwin, APoseOutOfReachAndARendererOfOneObjectAreSaid) {
  const auto scene = scene_with_a_ram();
  for (const bool in_process : {true, false}) {
    const Plugins plugins = loaded(in_process);
    const auto plugged = make_scene_renderer(model_for("god-object-scene-twin", plugins, {}), scene);
    plugged->reset();
    EXPECT_EQ(plugged->step({1.0, {0, 0, 0.1}, Quat::Identity()}).status, StepStatus::ok);
    EXPECT_EQ(plugged->step({9.0, {0, 0, 0.1}, Quat::Identity()}).status, StepStatus::failed);
    EXPECT_THAT(plugged->failure(), ::testing::HasSubstr("ram poses: the object's poses go from t_s = 0 to 3"));
    try {
      make_scene_renderer(model_for("spring-linear-scene-twin", plugins, {}), scene);
      ADD_FAILURE() << "it was made";
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("spring-linear-scene-twin takes one object"));
    }
  }
}

// Bodies at rest are one object, and one that moves is one in its own frame, for a plug-in that takes one as for the
// program's own renderers.
TEST(ScenePluginTwin, ARendererOfOneObjectTakesBodiesAtRestAndOneThatMoves) {
  const auto all = scene_with_a_ram();
  const auto some = [&](std::initializer_list<std::size_t> which) {
    auto scene = std::make_shared<BodyScene>();
    scene->source = "test scene";
    for (const std::size_t i : which) scene->bodies.push_back(all->bodies[i]);
    return scene;
  };
  const Plugins plugins = loaded(true);
  for (const auto& scene : {some({0, 1}), some({2})}) {
    const auto own = make_scene_renderer(model_of("spring-linear", {}), scene);
    const auto plugged = make_scene_renderer(model_for("spring-linear-scene-twin", plugins, {}), scene);
    own->reset();
    plugged->reset();
    int touched = 0;
    for (int i = 0; i < 500; ++i) {
      const double t_s = 1e-3 * (i + 1);
      const TipState tip{
          t_s, {-0.02 + 0.013 * std::sin(9.0 * t_s), 0.001, 0.004 * std::cos(20.0 * t_s)}, Quat::Identity()};
      const StepResult expected = own->step(tip);
      ASSERT_EQ(plugged->step(tip).f_W_N, expected.f_W_N) << i;
      touched += expected.contact ? 1 : 0;
    }
    EXPECT_GT(touched, 20);
  }
}

// One object at rest goes the way of version 1.
TEST(ScenePluginTwin, RendersOneObjectAsTheProgramDoes) {
  const Plugins plugins = loaded(true);
  const auto surface = make_embree_surface(testing::torus(0.02, 0.008, 24, 12));
  const auto own = make_renderer(model_of("spring-linear", {}), surface);
  const auto plugged = make_renderer(model_for("spring-linear-scene-twin", plugins, {}), surface);
  for (const double depth_m : {-1e-3, 1e-4, 2e-3}) {
    own->reset();
    plugged->reset();
    const TipState tip{1.0, {0.028 - depth_m, 0.0, 0.0}, Quat::Identity()};
    EXPECT_EQ(plugged->step(tip).f_W_N, own->step(tip).f_W_N);
  }
}

}  // namespace
}  // namespace touchstone::renderers
