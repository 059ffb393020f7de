// What the atlas says of cases whose answer is known, and the known limits of renderers: expected to fail, so that one
// that begins to pass is noticed and its limit taken back.
#include <gtest/gtest.h>

#include "atlas/atlas_report.h"

namespace touchstone::atlas {
namespace {

TEST(Atlas, AGodObjectFollowsAGentleBumpPressedStiffly) {
  for (const std::string renderer : {"god-object", "friction-cone", "force-shading"}) {
    const AtlasCase own = run_case(Scene::bump, renderer, 0.4, 3200, 0.0);
    EXPECT_EQ(letters(own.found), "") << renderer;
    EXPECT_LT(own.found.largest_lag_m, 1e-3) << renderer;
    EXPECT_GT(own.found.samples, 1000U);
  }
}

TEST(Atlas, NoProxyPopsThroughAShellOrLosesIt) {
  for (const std::string renderer : {"god-object", "friction-cone", "force-shading"}) {
    for (const double thickness : {2e-3, 5e-5}) {
      for (const double stiffness : {100.0, 3200.0}) {
        for (const double mu : {0.0, 0.5}) {
          EXPECT_EQ(letters(run_case(Scene::shell, renderer, thickness, stiffness, mu).found), "")
              << renderer << " " << thickness << " m, " << stiffness << " N/m, mu " << mu;
        }
      }
    }
  }
}

// Expected failures. Should one of these stop failing, the renderer has become better: take the limit back in its
// declaration and in docs/explanation/friction-shading-atlas.md.
TEST(AtlasKnownLimits, TheProxySticksOnASteepBumpWherePressedDeep) {
  // Figure 8: the tip, F/k = 15 mm deep, turns about the edge; the nearest place stays on the side.
  const AtlasCase own = run_case(Scene::bump, "god-object", 1.2, 100, 0.0);
  EXPECT_NE(letters(own.found).find('s'), std::string::npos);
  EXPECT_GT(own.found.largest_lag_m, 5e-3);
}

TEST(AtlasKnownLimits, PenaltyPopsThroughShellsThinnerThanTwiceTheDepth) {
  for (const double thickness : {2e-3, 1e-3, 1e-4}) {
    const double depth = 1.5 / 800;
    ASSERT_LT(thickness, 2.0 * depth);
    const std::string shown = letters(run_case(Scene::shell, "penalty", thickness, 800, 0.0).found);
    EXPECT_TRUE(shown.find('p') != std::string::npos || shown.find('l') != std::string::npos) << thickness;
  }
  EXPECT_EQ(letters(run_case(Scene::shell, "penalty", 2e-3, 3200, 0.0).found), "") << "0.5 mm into 2 mm it does not";
}

TEST(AtlasKnownLimits, PenaltyPopsOrSlipsOffASteepBumpWherePressedDeep) {
  EXPECT_NE(letters(run_case(Scene::bump, "penalty", 1.55, 100, 0.0).found), "");
}

}  // namespace
}  // namespace touchstone::atlas
