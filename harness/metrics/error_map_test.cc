#include "harness/metrics/error_map.h"

#include <limits>

#include "harness/base/random.h"

namespace touchstone::metrics {
namespace {

TEST(ErrorMap, AConstantErrorIsThatConstantEverywhereNear) {
  Random random(3);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    ErrorMap map(0.1 * scale);
    std::vector<Vec3> points;
    for (int i = 0; i < 500; ++i) points.push_back(scale * random.direction());
    for (const Vec3& p : points) map.add(p, 0.25);
    for (const Vec3& p : points) EXPECT_NEAR(*map.at(p), 0.25, 1e-15);
  }
}

TEST(ErrorMap, NothingWhereNothingTouched) {
  ErrorMap map(1.0);
  map.add(Vec3::Zero(), 1.0);
  EXPECT_TRUE(map.at(Vec3(0.9, 0, 0)));
  EXPECT_FALSE(map.at(Vec3(4, 0, 0)));
  EXPECT_FALSE(map.at(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
}

TEST(ErrorMap, TheWorstPlaceStandsOut) {
  ErrorMap map(0.1);
  for (int i = 0; i < 1000; ++i) map.add(Vec3(0.001 * i, 0, 0), i > 600 && i < 700 ? 2.0 : 0.1);
  EXPECT_GT(*map.at(Vec3(0.65, 0, 0)), 1.0);
  EXPECT_NEAR(*map.at(Vec3(0.05, 0, 0)), 0.1, 1e-12);
}

TEST(ErrorMap, LeavesOutWhatIsNotFinite) {
  ErrorMap map(0.1);
  map.add(Vec3::Zero(), std::numeric_limits<double>::quiet_NaN());
  map.add(Vec3::Constant(std::numeric_limits<double>::infinity()), 1.0);
  EXPECT_EQ(map.cells(), 0u);
}

}  // namespace
}  // namespace touchstone::metrics
