#include "harness/recording/child_trial.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace touchstone::recording {
namespace {

TEST(ChildTrial, TellsACrashFromAnErrorAndLeavesNothingBehind) {
  int touched = 0;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(try_in_child([&] { touched = 1; }), ChildOutcome::survived);
  EXPECT_EQ(try_in_child([] { throw std::runtime_error("refused"); }), ChildOutcome::survived);
  EXPECT_EQ(try_in_child([] { std::fputs("noise\n", stderr); }), ChildOutcome::survived);
  EXPECT_EQ(try_in_child([] { std::abort(); }), ChildOutcome::crashed);
  EXPECT_EQ(try_in_child([] { std::raise(SIGSEGV); }), ChildOutcome::crashed);
  EXPECT_EQ(try_in_child([] { std::_Exit(1); }), ChildOutcome::crashed);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(touched, 0) << "the work was done in another process";
}

}  // namespace
}  // namespace touchstone::recording
