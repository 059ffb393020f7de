#include "harness/recording/extent_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::recording {
namespace {

using ::testing::HasSubstr;

Box3 box(const Vec3& centre, double size) {
  return {centre - Vec3::Constant(size / 2), centre + Vec3::Constant(size / 2)};
}

TEST(ExtentCheck, AScanOfAPartOrFromOutsideFits) {
  const Box3 mesh = box(Vec3(0.3, 0, 0), 0.1);
  EXPECT_FALSE(check_extents(box(Vec3(0.3, 0, 0.05), 0.1), mesh, "m"));
  EXPECT_FALSE(check_extents(box(Vec3(0.33, 0, 0.05), 0.005), mesh, "m"));
  EXPECT_FALSE(check_extents(box(Vec3(0.3, 0, 0.3), 0.4), mesh, "m"));
}

TEST(ExtentCheck, NamesTheUnitThatWouldFit) {
  const Box3 recording = box(Vec3(0.1, -0.2, 0.05), 0.08);
  for (const auto& [read, meant, factor] :
       {std::tuple{"m", "mm", 1e3}, {"mm", "m", 1e-3}, {"m", "cm", 1e2}, {"cm", "mm", 10.0}}) {
    const Box3 mesh = box(Vec3(0.1, -0.2, 0.05) * factor, 0.1 * factor);
    const auto mismatch = check_extents(recording, mesh, read);
    ASSERT_TRUE(mismatch) << read << " " << meant;
    EXPECT_TRUE(mismatch->apart);
    EXPECT_THAT(mismatch->message, HasSubstr(std::string("--mesh-unit ") + meant));
  }
}

TEST(ExtentCheck, AMeshAroundTheOriginOverlapsWhateverItsUnit) {
  const auto mismatch = check_extents(box(Vec3::Zero(), 0.08), box(Vec3::Zero(), 100.0), "m");
  ASSERT_TRUE(mismatch);
  EXPECT_FALSE(mismatch->apart);
  EXPECT_THAT(mismatch->message, HasSubstr("is the mesh in mm? It would fit: --mesh-unit mm"));
}

TEST(ExtentCheck, AnotherFrameIsSaidToo) {
  const auto mismatch = check_extents(box(Vec3(5, 5, 5), 0.1), box(Vec3::Zero(), 0.1), "m");
  ASSERT_TRUE(mismatch);
  EXPECT_TRUE(mismatch->apart);
  EXPECT_THAT(mismatch->message, HasSubstr("same frame"));
}

}  // namespace
}  // namespace touchstone::recording
