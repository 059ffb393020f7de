// The stiffest wall against linear theory, where that holds: exact positions, no dry friction, no force limit.
#include "servo/width.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::servo {
namespace {

LoopSetup ideal_device(const std::string& grip, double mass_kg) {
  return make_setup("virtuose-6d", grip, {{"mass_kg", mass_kg}, {"damping_N_s_per_m", 0.5}, {"force_limit_N", 1e6}}, 1);
}

TEST(Width, IsThatOfLinearTheoryForAnExactDevice) {
  double worst = 0.0, lowest = 1.0, highest = 0.0;
  for (const auto& [grip, mass_kg] : {std::pair{"light", 0.1}, {"light", 0.3}, {"firm", 0.1}}) {
    const LoopSetup setup = ideal_device(grip, mass_kg);
    for (const auto& [over, at] : {std::pair{WidthOver::virtual_damping, std::vector{0.0, 2.0, 6.0}},
                                   {WidthOver::latency, std::vector{0.5e-3, 2e-3, 4e-3}},
                                   {WidthOver::period, std::vector{0.5e-3, 2e-3}}}) {
      for (const WidthPoint& point : stable_width(setup, over, at, {})) {
        const double error = point.held_N_per_m / point.linear_N_per_m - 1.0;
        fmt::print("{:5} {:.1f} kg, at {:6.4f}: not felt {:7.0f}, held {:7.0f}, theory {:7.0f} N/m: {:+.1f} %\n", grip,
                   mass_kg, point.at, point.unfelt_N_per_m, point.held_N_per_m, point.linear_N_per_m, 100.0 * error);
        // A heavy device in a soft hand goes on bouncing below the limit, longer than the wall is pressed.
        lowest = std::min(lowest, 1.0 + error);
        highest = std::max(highest, 1.0 + error);
        if (std::string(grip) == "light" && mass_kg < 0.2) worst = std::max(worst, std::abs(error));
        EXPECT_LE(point.unfelt_N_per_m, point.held_N_per_m);
      }
    }
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_GT(lowest, 0.7);
  EXPECT_LT(highest, 1.03);
}

TEST(Width, ATunedWallIsStableAndItsDampingPays) {
  const LoopSetup setup = ideal_device("light", 0.1);
  const TunedWall once = tune({setup}, 1.0, {}), twice = tune({setup}, 2.0, {});
  EXPECT_NEAR(twice.undamped_N_per_m, 0.5 * once.undamped_N_per_m, 0.04 * once.undamped_N_per_m);
  EXPECT_GT(once.stiffness_N_per_m, 1.5 * once.undamped_N_per_m);
  EXPECT_GT(once.virtual_damping_N_s_per_m, 0.0);
}

}  // namespace
}  // namespace touchstone::servo
