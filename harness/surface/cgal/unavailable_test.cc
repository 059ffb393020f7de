#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"
#include "harness/surface/cgal/exact_surface.h"
#include "harness/surface/cgal/self_intersection.h"

namespace touchstone::surface {
namespace {

TEST(WithoutCgal, SaysSo) {
  EXPECT_FALSE(exact_surface_available());
  EXPECT_EQ(self_intersections({}), std::nullopt);
  try {
    make_exact_surface({});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("TOUCHSTONE_WITH_CGAL"));
  }
}

}  // namespace
}  // namespace touchstone::surface
