#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"
#include "harness/surface_cgal/exact_surface.h"
#include "harness/surface_cgal/self_intersection.h"

namespace touchstone {
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
}  // namespace touchstone
