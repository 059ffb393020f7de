#include "harness/base/known_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone {
namespace {

TEST(KnownNames, FindsSlipsAndNoFarFetchedOnes) {
  const std::vector<std::string> known{"god-object", "penalty", "voxel"};
  EXPECT_EQ(closest_name("god-objekt", known), "god-object");
  EXPECT_EQ(closest_name("godobject", known), "god-object");
  EXPECT_EQ(closest_name("pen", known), "penalty");
  EXPECT_EQ(closest_name("txet", {"test", "text", "rest"}), "text");
  EXPECT_EQ(closest_name("spring", known), "");
  EXPECT_EQ(closest_name("", known), "");
}

TEST(KnownNames, MessageListsTheKnown) {
  EXPECT_THAT(unknown_name("renderer", "voxle", {"penalty", "voxel"}),
              ::testing::StrEq("there is no renderer \"voxle\"; did you mean \"voxel\"? known: penalty, voxel"));
  EXPECT_THAT(unknown_name("effect", "x", {}), ::testing::HasSubstr("none is known"));
}

}  // namespace
}  // namespace touchstone
