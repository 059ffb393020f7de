// The texture as a renderer: which way its vibration goes, and when there is none.
#include "texture_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "harness/base/error.h"
#include "harness/rendering/parameters.h"
#include "harness/surface/embree_surface.h"
#include "made_texture_for_test.h"
#include "texture_signal.h"

namespace touchstone::texture {
namespace {

using rendering::Parameters;
using rendering::Renderer;
using rendering::RendererEntry;

std::unique_ptr<Renderer> made_renderer(const TextureModel& model = made_texture()) {
  surface::TriangleMesh plate;
  plate.source = "plate";
  plate.vertices_W_m = {{-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}, {-1.0, 1.0, 0.0}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  const RendererEntry entry = texture_renderer_entry(std::make_shared<const TextureModel>(model));
  return entry.make(Parameters(entry.parameters, {{"seed", 9.0}}, entry.name, "test", ""),
                    surface::make_embree_surface(plate));
}

// Along x at 100 mm/s, 2 mm deep at 500 N/m: friction goes along x, the vibration along y, the load along z.
TEST(TextureRenderer, TheVibrationGoesAcrossThePathAndIsTheSignalTimesTheMass) {
  const auto renderer = made_renderer();
  TextureSignal signal(std::make_shared<const TextureModel>(made_texture()), 9);
  std::vector<double> accelerations;
  double squares = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const auto result = renderer->step({0.001 * i, {-0.2 + 1e-4 * i, 0.0, -0.002}});
    // The same speeds as the renderer's own filter gives: w^2 u + 2 (1 - w) v - (1 - w)^2 v', here of a step at i = 1.
    const double n = i, w = 0.125 / 1.125;
    const double speed = i == 0 ? 0.0 : 0.1 * (1.0 - (1.0 + n * w) * std::pow(1.0 - w, n));
    accelerations.push_back(signal.next(speed, 1.0));
    if (i < 200) continue;
    ASSERT_NEAR(result.f_W_N.z(), 1.0, 1e-9);
    ASSERT_NEAR(result.f_W_N.x(), -0.35, 1e-9);
    // x cross z is -y.
    const double expected =
        -default_effective_mass_kg * accelerations[accelerations.size() - 1 - TexturePlayer::half_width];
    ASSERT_NEAR(result.f_W_N.y(), expected, 1e-4 * 0.05 + 1e-4 * std::abs(expected));
    squares += expected * expected;
  }
  EXPECT_GT(std::sqrt(squares / 2800.0), 0.03);
}

TEST(TextureRenderer, APressIsSilent) {
  const auto renderer = made_renderer();
  for (int i = 0; i < 2000; ++i) {
    const auto result = renderer->step({0.001 * i, {0.0, 0.0, 0.002 * std::cos(0.01 * i)}});
    ASSERT_EQ(result.f_W_N.x(), 0.0);
    ASSERT_EQ(result.f_W_N.y(), 0.0);
  }
}

// Of a texture that depends on the speed alone: a tip that sinks while it slides is no faster along the surface.
TEST(TextureRenderer, SinkingIsNoSliding) {
  TextureModel model = made_texture();
  for (TextureNode& node : model.nodes) {
    node.ar_rad = model.nodes[0].ar_rad;
    node.variance = node.speed_m_per_s;
  }
  const auto level = made_renderer(model), sinking = made_renderer(model);
  for (int i = 0; i < 1000; ++i) {
    const double one = level->step({0.001 * i, {1e-4 * i, 0.0, -0.002}}).f_W_N.y();
    ASSERT_NEAR(sinking->step({0.001 * i, {1e-4 * i, 0.0, -0.002 - 5e-5 * i}}).f_W_N.y(), one, 1e-9);
  }
}

TEST(TextureRenderer, ResetBeginsAgain) {
  const auto renderer = made_renderer();
  std::vector<Vec3> first;
  for (int i = 0; i < 300; ++i) first.push_back(renderer->step({0.001 * i, {1e-4 * i, 0.0, -0.002}}).f_W_N);
  renderer->reset();
  for (int i = 0; i < 300; ++i)
    ASSERT_EQ(renderer->step({0.001 * i, {1e-4 * i, 0.0, -0.002}}).f_W_N, first[static_cast<std::size_t>(i)]);
}

TEST(TextureRenderer, WithoutAModelItSaysWhy) {
  const RendererEntry entry = texture_renderer_entry(nullptr, "no texture here");
  EXPECT_THROW(entry.make(Parameters(entry.parameters, {}, entry.name, "test", ""), nullptr), BadData);
}

}  // namespace
}  // namespace touchstone::texture
