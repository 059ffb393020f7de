#include "harness/base/named_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"

namespace touchstone {
namespace {

std::string refusal(const std::vector<std::string>& texts) {
  try {
    named_values("--param", texts);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(NamedValues, AreReadByName) {
  const auto values = named_values("--param", {"radius_m=0.03", "mu=1e-2"});
  EXPECT_EQ(values.size(), 2U);
  EXPECT_EQ(values.at("radius_m"), 0.03);
  EXPECT_EQ(values.at("mu"), 0.01);
}

TEST(NamedValues, NameTheOptionThatIsWrong) {
  for (const char* const text : {"radius_m", "=3", "radius_m=", "radius_m=3mm", "radius_m=1,5"})
    EXPECT_THAT(refusal({text}), ::testing::HasSubstr("--param '" + std::string(text) + "'")) << text;
  EXPECT_THAT(refusal({"mu=1", "mu=2"}), ::testing::HasSubstr("--param mu is given twice"));
}

TEST(NamedFile, IsSplitAtItsFirstEqualsSign) {
  EXPECT_EQ(named_file("--model", "soft=a=b.json"), std::pair(std::string("soft"), std::string("a=b.json")));
  for (const char* const text : {"soft", "=a.json", "soft="}) EXPECT_THROW(named_file("--model", text), UsageError);
}

}  // namespace
}  // namespace touchstone
