// Every renderer in the loop as theory says: on a plane it is the flat wall, stable below the limit and not above.
#include "servo/atlas.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "servo/flat_wall.h"
#include "servo/limits.h"
#include "synthetic/generators.h"

namespace touchstone::servo {
namespace {

LoopSetup exact_setup() {
  return make_setup("touch", "light", {{"mass_kg", 0.1}, {"friction_N", 0.0}, {"resolution_m", 0.0}}, 1);
}

TEST(Atlas, EveryRendererIsStableBelowTheLimitAndNotAboveIt) {
  const LoopSetup setup = exact_setup();
  const double limit = critical_gain(setup.parameters)->stiffness_N_per_m;
  for (const auto& entry : renderers::renderer_catalogue()) {
    if (entry.name == "spring-quadratic") continue;  // it has no stiffness
    for (const auto& [share, stable] : {std::pair{0.4, true}, {2.0, false}}) {
      const AtlasAnswer answer = atlas_answer(renderers::built_in_catalogue(), synthetic::built_in_generators(),
                                              atlas_model(entry, share * limit), atlas_cases().front(), setup, {});
      EXPECT_EQ(answer.refused, "");
      EXPECT_EQ(answer.verdict == Verdict::stable, stable)
          << entry.name << " at " << share << " of the limit: " << sentence(answer.worst);
    }
  }
}

TEST(Atlas, AGodObjectOnAPlaneOfTrianglesIsTheFlatWall) {
  const LoopSetup setup = exact_setup();
  const auto& generators = synthetic::built_in_generators();
  const auto mesh = generators.mesh("plane", {}, 10000).mesh;
  const auto renderer = renderers::make_renderer(atlas_model(renderers::renderer_catalogue().front(), 1000.0),
                                                 surface::make_embree_surface(mesh));
  const MotionColumns path = atlas_path(*generators.surface("plane", {}), setup.parameters);
  FlatWall wall(1000.0);
  const LoopTrace on_mesh = run_loop(*renderer, path, setup.parameters),
                  on_wall = run_loop(wall, path, setup.parameters);
  ASSERT_EQ(on_mesh.size(), on_wall.size());
  double worst_m = 0.0;
  for (std::size_t i = 0; i < on_mesh.size(); ++i)
    worst_m = std::max(worst_m, (on_mesh.tip_W_m[i] - on_wall.tip_W_m[i]).norm());
  fmt::print("largest difference of the tip over {} ticks: {:.1e} m\n", on_mesh.size(), worst_m);
  EXPECT_LT(worst_m, 1e-12);
}

}  // namespace
}  // namespace touchstone::servo
