#include "harness/report/listing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace touchstone::report {
namespace {

const ListedKind effects{
    "effects", "Effects", {{"friction", "Coulomb", {{"mu", "1", "coefficient", 0.5}}}, {"lag", "late", {}}}};

TEST(Listing, TheTextHasEachItemWithItsParametersBelow) {
  EXPECT_EQ(listing_text(effects),
            "Effects\n  friction  Coulomb\n              mu [1], 0.5 where not set: coefficient\n  lag       late\n\n");
}

TEST(Listing, TheJsonKeepsKindsAndOrder) {
  const auto json = nlohmann::ordered_json::parse(listing_json({effects, {"metrics", "Metrics", {}}}));
  EXPECT_EQ(json["schema"], "touchstone-list/1");
  EXPECT_EQ(json["effects"][0]["parameters"][0]["default"], 0.5);
  EXPECT_FALSE(json["effects"][1].contains("parameters"));
  EXPECT_TRUE(json["metrics"].is_array());
}

}  // namespace
}  // namespace touchstone::report
