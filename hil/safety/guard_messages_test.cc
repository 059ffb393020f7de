#include "safety/guard_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace touchstone::hil {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

std::string passed_on(const std::string& what) {
  GuardReply reply;
  reply.status = static_cast<int>(DeviceStatus::no_driver);
  reply.advised = 1;
  copy_message(reply.message, what);
  return problem_of(reply).what();
}

// Four paths of a vendor's library that were tried, and what to do: 255 characters held none of the advice.
TEST(GuardMessages, ALongMessageKeepsItsAdvice) {
  std::string problem = "none of";
  for (int i = 0; i < 4; ++i)
    problem += " /opt/vendor/a-long-name-of-a-development-kit-3.17.6/lib/lin-x86_64/libdhd.so.3";
  const DeviceError error(DeviceStatus::no_driver, problem + " could be opened", "install the vendor's kit");
  ASSERT_GT(std::string(error.what()).size(), 255U);
  EXPECT_EQ(passed_on(error.what()), error.what());
}

TEST(GuardMessages, OfOneThatIsTooLongTheMiddleGoes) {
  const std::string said = "the device says: " + std::string(5000, 'x') + "; switch it off and on";
  const std::string passed = passed_on(said);
  EXPECT_THAT(passed, StartsWith("the device says: xxx"));
  EXPECT_THAT(passed, EndsWith("xxx; switch it off and on"));
  EXPECT_THAT(passed, ::testing::HasSubstr("x [...] x"));
  EXPECT_LT(passed.size(), longest_message);
}

}  // namespace
}  // namespace touchstone::hil
