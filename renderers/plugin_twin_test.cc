// A renderer behind the plug-in interface gives the same bits as in the program: in process and in a child, alone and
// under effects.
#include <gtest/gtest.h>

#include <cstdlib>

#include "harness/base/random.h"
#include "harness/plugin/plugin.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"

namespace touchstone::renderers {
using rendering::TipState;

using namespace touchstone::testing;  // the suite
namespace {

struct Run {
  std::string name;
  std::string json;  // the model after "renderer"
};

std::vector<TipState> hand_over(const surface::TriangleMesh& mesh, double scale) {
  Random random(7);
  const auto surface = make_embree_surface(mesh);
  std::vector<TipState> tips;
  Vec3 p = surface->bounds().max() * 1.2;
  for (int i = 0; i < 3000; ++i) {
    // Drawn to just below the surface, and shaken.
    const surface::SurfacePoint foot = surface->closest(p);
    const double depth = 4e-4 * scale * std::sin(0.01 * i);
    p += 0.1 * (foot.p_W_m - depth * foot.n_W - p) + 2e-4 * scale * random.direction();
    tips.push_back({1e-3 * (i + 1), p, random.rotation()});
  }
  return tips;
}

class PluginTwin : public ::testing::TestWithParam<Run> {};

TEST_P(PluginTwin, GivesTheSameBits) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const bool in_process : {true, false}) {
      SCOPED_TRACE(fmt::format("scale {}, in process {}", scale, in_process));
      plugin::PluginOptions options;
      options.in_process = in_process;
      plugin::Plugins plugins;
      plugins.load(std::getenv("TOUCHSTONE_TWIN_PLUGIN"), options, {});
      const surface::TriangleMesh mesh =
          moved(testing::torus(0.02, 0.008, 24, 12), awkward_rotation(), {0.01, 0.02, -0.03}, scale);
      const auto model = [&](const std::string& suffix) {
        rendering::Model made = rendering::parse_model(R"({"schema": "touchstone-model/1", "renderer": ")" +
                                                           GetParam().name + suffix + "\", " + GetParam().json + "}",
                                                       "test");
        plugins.provide(made);
        return made;
      };
      const auto own = make_renderer(model(""), make_embree_surface(mesh));
      const auto plugged = make_renderer(model("-twin"), make_embree_surface(mesh));
      own->reset();
      plugged->reset();
      int touching = 0;
      for (const TipState& tip : hand_over(mesh, scale)) {
        const rendering::StepResult expected = own->step(tip);
        const rendering::StepResult obtained = plugged->step(tip);
        ASSERT_EQ(obtained.status, rendering::StepStatus::ok) << plugged->failure();
        ASSERT_EQ(obtained.f_W_N, expected.f_W_N) << tip.t_s;
        ASSERT_EQ(obtained.contact_W_m, expected.contact_W_m) << tip.t_s;
        ASSERT_EQ(obtained.n_W, expected.n_W) << tip.t_s;
        ASSERT_EQ(obtained.depth_m, expected.depth_m) << tip.t_s;
        ASSERT_EQ(obtained.contact, expected.contact) << tip.t_s;
        touching += expected.contact ? 1 : 0;
      }
      EXPECT_GT(touching, 300);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Renderers, PluginTwin,
    ::testing::Values(
        Run{"god-object", R"("parameters": {"stiffness_N_per_m": 731.5})"},
        Run{"god-object",
            R"("effects": [{"name": "coulomb-friction", "parameters": {"mu_static": 0.4, "mu_dynamic": 0.3}}])"},
        Run{"spring-linear", R"("parameters": {"stiffness_N_per_m": 0.125})"}),
    [](const auto& tested) {
      std::string name = tested.param.name + "_" + std::to_string(tested.index);
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace touchstone::renderers
