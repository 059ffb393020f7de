// What the program lists is what the user's guide holds.
#include "listing.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "harness/base/atomic_file.h"
#include "harness/base/json_reader.h"

namespace touchstone::datasets {
namespace {

TEST(Listing, GuideHoldsTheCatalogue) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  ASSERT_NE(source, nullptr) << "ctest sets it";
  const std::string guide = read_file(std::filesystem::path(source) / "docs" / "reference" / "synthetic.md");
  EXPECT_TRUE(guide.ends_with(catalogue_markdown()))
      << "bring docs/reference/synthetic.md up to date with touchstone synth --list";
}

TEST(Listing, JsonNamesEveryEntry) {
  const nlohmann::json listed = parse_json(catalogue_json(), "catalogue");
  EXPECT_EQ(listed["schema"], "touchstone-synthetic/1");
  EXPECT_EQ(listed["surfaces"].size(), 19U);
  EXPECT_EQ(listed["trajectories"].size(), 8U);
  EXPECT_EQ(listed["datasets"].size(), 2U);
}

}  // namespace
}  // namespace touchstone::datasets
