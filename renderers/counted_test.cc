// Counted renderers: the same forces to the bit as the plain ones, on every shape, and counts that repeat.
#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/rendering/operations.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/testing.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone {
namespace {

std::vector<Vec3> tips_about(const Surface& surface, std::uint64_t seed, int count) {
  Random random(seed);
  const Box3 box = surface.bounds();
  const double size = box.sizes().maxCoeff();
  std::vector<Vec3> tips;
  SurfacePoint foot = surface.closest(box.max() + 0.2 * Vec3(0.3, 0.2, 1.0) * size);
  for (int i = 0; i < count; ++i) {
    if (i % 100 == 0) foot = surface.closest(box.center() + size * random.direction());
    const double depth = size * 0.02 * std::sin(0.1 * i);
    tips.push_back(foot.p_W_m - depth * foot.n_W);
    foot = surface.closest(foot.p_W_m + 2e-3 * size * random.direction());
  }
  return tips;
}

TipSource source_of(const std::vector<Vec3>& tips) {
  return [&tips, next = std::size_t{0}](TipState& tip) mutable {
    if (next == tips.size()) return false;
    tip.p_W_m = tips[next++];
    tip.t_s = static_cast<double>(next) * 1e-3;
    return true;
  };
}

class CountedRendererOf : public ::testing::TestWithParam<std::string> {};

TEST_P(CountedRendererOf, GivesTheSameBitsAndTheSameCountsAgain) {
  for (const char* shape : {"duck", "v-groove", "thin-shell", "gauss", "extrusion"}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const std::shared_ptr<const Surface> surface =
          make_embree_surface(testing::moved(synthetic::make_mesh(shape, {}, 1500).mesh, testing::awkward_rotation(),
                                             scale * Vec3(1, 2, 3) * 0.01, scale));
      Model model = testing::model_of(GetParam(), {});
      // Takes samples of the whole body: few of them say as much here.
      if (GetParam() == "implicit") model.parameters["resolution"] = 20.0;
      const auto plain = make_renderer(model, surface);
      const CountedRenderer counted = make_counted_renderer(model, surface);
      ASSERT_NE(counted.renderer, nullptr) << counted.not_counted;
      EXPECT_EQ(counted.not_counted, "");
      const auto tips = tips_about(*surface, 3, 1500);
      plain->reset();
      int touching = 0;
      for (std::size_t i = 0; i < tips.size(); ++i) {
        const TipState tip{static_cast<double>(i) * 1e-3, tips[i], Quat::Identity()};
        const StepResult a = plain->step(tip);
        const StepResult b = counted.renderer->step(tip);
        ASSERT_EQ(a.f_W_N, b.f_W_N) << shape << " scale " << scale << " step " << i;
        ASSERT_EQ(a.contact_W_m, b.contact_W_m);
        ASSERT_EQ(a.n_W, b.n_W);
        ASSERT_EQ(a.contact, b.contact);
        touching += a.contact ? 1 : 0;
      }
      // Of a shell thinner than its samples the implicit renderer feels little, as it declares.
      const bool too_thin = GetParam() == "implicit" && std::string_view(shape) == "thin-shell";
      EXPECT_GT(touching, too_thin ? 20 : GetParam() == "implicit" ? 200 : 300) << shape;
      const OperationReport once = count_operations(*counted.renderer, source_of(tips));
      const OperationReport again = count_operations(*make_counted_renderer(model, surface).renderer, source_of(tips));
      EXPECT_EQ(once.counts, again.counts);
      EXPECT_EQ(once.steps, tips.size());
      EXPECT_GT(once.mean, 5.0);
      EXPECT_LE(once.median, static_cast<double>(once.max));
    }
  }
}

std::vector<std::string> counted_renderers() {
  std::vector<std::string> names;
  for (const auto& entry : renderer_catalogue()) {
    if (entry.make_counted != nullptr) names.push_back(entry.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, CountedRendererOf, ::testing::ValuesIn(counted_renderers()), [](const auto& of) {
  std::string name = of.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(CountedRenderer, FrictionAndOpenMeshesToTheBit) {
  const std::shared_ptr<const Surface> sheet = make_embree_surface(testing::grid(0.05, 10));
  for (const auto& [renderer, mu] : {std::pair{"friction-cone", 0.0}, {"friction-cone", 0.3}, {"force-shading", 0.3}}) {
    const Model model = testing::model_of(renderer, {{"mu_static", 1.5 * mu}, {"mu_dynamic", mu}});
    const auto plain = make_renderer(model, sheet);
    const CountedRenderer counted = make_counted_renderer(model, sheet);
    ASSERT_NE(counted.renderer, nullptr);
    Random random(5);
    Vec3 tip(0.0, 0.0, 0.002);
    for (int i = 0; i < 20000; ++i) {
      tip += 1e-4 * random.direction() - 1e-2 * Vec3(tip.x(), tip.y(), tip.z() + 1e-3);
      if (i % 500 == 0) tip = {random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06), 0.002};
      const TipState now{static_cast<double>(i) * 1e-3, tip, Quat::Identity()};
      const StepResult a = plain->step(now);
      const StepResult b = counted.renderer->step(now);
      ASSERT_EQ(a.f_W_N, b.f_W_N) << i;
      ASSERT_EQ(a.contact_W_m, b.contact_W_m) << i;
    }
  }
}

TEST(CountedRenderer, SaysWhatIsNotCounted) {
  const CountedRenderer ball = make_counted_renderer(testing::model_of("god-object", {{"tip_radius_m", 1e-3}}),
                                                     make_embree_surface(testing::cube(0.02)));
  EXPECT_EQ(ball.renderer, nullptr);
  EXPECT_EQ(ball.not_counted, "the renderer god-object with this tip or on this mesh");
  const std::shared_ptr<const Surface> mesh = make_embree_surface(testing::cube(0.02));
  const CountedRenderer shaded =
      make_counted_renderer(testing::model_of("force-shading", {{"tip_radius_m", 1e-3}}), mesh);
  EXPECT_EQ(shaded.renderer, nullptr);
  EXPECT_EQ(shaded.not_counted, "the renderer force-shading with this tip or on this mesh");
  const CountedRenderer analytic =
      make_counted_renderer(testing::model_of("implicit", {}), synthetic::make_surface("sphere"));
  EXPECT_EQ(analytic.renderer, nullptr);
  EXPECT_EQ(analytic.not_counted, "the arithmetic of an analytic surface");
  Model friction = testing::model_of("penalty", {});
  friction.effects.push_back({"coulomb-friction", {{"mu_static", 0.3}, {"mu_dynamic", 0.3}}, "/effects/0"});
  const CountedRenderer with = make_counted_renderer(friction, mesh);
  EXPECT_NE(with.renderer, nullptr);
  EXPECT_EQ(with.not_counted, "the effects of the contact");
}

}  // namespace
}  // namespace touchstone
