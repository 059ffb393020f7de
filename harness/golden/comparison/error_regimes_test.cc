#include "harness/golden/comparison/error_regimes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::golden {
namespace {

// Down onto a plane for a second, along it for a second at constant depth, up again; at 1 kHz.
TrajectoryColumns press_slide_lift(double scale) {
  TrajectoryColumns set{"golden", {}};
  for (const char* const name : {"t", "x", "y", "z", "fx", "fy", "fz"}) set.columns.push_back({name, {}});
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.001 * i;
    const double z = t < 1.0 ? 0.5 - t : t < 2.0 ? -0.5 : t - 2.5;
    const double x = t < 1.0 ? 0.0 : t < 2.0 ? t - 1.0 : 1.0;
    const std::array values{t, scale * x, 0.0, scale * z, 0.0, 0.0, std::max(0.0, -z)};
    for (std::size_t c = 0; c < values.size(); ++c) set.columns[c].values.push_back(values[c]);
  }
  return set;
}

const RegimeError& regime(const ErrorPlaces& places, const std::string& name) {
  for (const auto& r : places.regimes) {
    if (r.name == name) return r;
  }
  throw std::out_of_range(name);
}

TEST(ErrorRegimes, AnErrorWhileSlidingIsFoundThereAtEveryScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto golden = press_slide_lift(scale);
    auto obtained = golden;
    for (std::size_t i = 1200; i < 1800; ++i) obtained.columns[4].values[i] += 0.1;
    const auto places = locate_error(golden, obtained);
    EXPECT_NEAR(places.axis_share[0], 1.0, 1e-12);
    EXPECT_NEAR(regime(places, "sliding").share, 1.0, 1e-12);
    EXPECT_EQ(regime(places, "loading").share, 0.0);
    EXPECT_GE(places.region_W_m.min().x(), 0.19 * scale);
    EXPECT_LE(places.region_W_m.max().x(), 0.81 * scale);
  }
}

TEST(ErrorRegimes, LoadingUnloadingEventsAndFreeAirAreToldApart) {
  const auto golden = press_slide_lift(0.01);
  const auto share_at = [&](std::size_t row, const char* name) {
    auto obtained = golden;
    obtained.columns[6].values[row] += 0.1;
    return regime(locate_error(golden, obtained), name).share;
  };
  EXPECT_EQ(share_at(800, "loading"), 1.0);
  EXPECT_EQ(share_at(2200, "unloading"), 1.0);
  EXPECT_EQ(share_at(505, "contact event"), 1.0);
  EXPECT_EQ(share_at(100, "free air"), 1.0);
}

TEST(ErrorRegimes, WithoutErrorOrColumnsThereIsNoPlace) {
  const auto golden = press_slide_lift(1.0);
  EXPECT_TRUE(locate_error(golden, golden).region_W_m.isEmpty());
  EXPECT_TRUE(locate_error(golden, {"empty", {}}).regimes.empty());
}

}  // namespace
}  // namespace touchstone::golden
