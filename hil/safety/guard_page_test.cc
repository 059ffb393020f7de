#include "safety/guard_page.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace touchstone::hil {
namespace {

// A guard that tries for an hour must not lose why it does.
TEST(GuardPage, RepeatsAreCountedAndTheFirstReasonStays) {
  const auto page = make_guard_page();
  page->log(1.0, GuardPhase::letting_go, Trip::driver_gone, "the driver's process died");
  for (int i = 0; i < 40000; ++i) page->log(2.0 + i, GuardPhase::rescue, Trip::driver_gone, "an attempt failed");
  for (int i = 0; i < 1000; ++i) page->log(9.0, GuardPhase::rescue, Trip::driver_gone, fmt::format("{}", i).c_str());
  const auto events = page->events();
  ASSERT_EQ(events.size(), 128U);
  EXPECT_EQ(events[0].what, "the driver's process died");
  EXPECT_EQ(events[0].reason, Trip::driver_gone);
  EXPECT_EQ(events[1].times, 40000U);
  EXPECT_EQ(events[1].t_s, 2.0);
  EXPECT_EQ(events.back().what, "999");
  EXPECT_EQ(events[63].what, "61");
  EXPECT_EQ(events[64].what, "936") << "of those after the first 64 the last are kept";
}

TEST(GuardPage, TheFirstTripStays) {
  const auto page = make_guard_page();
  page->trip_for(Trip::stale);
  page->trip_for(Trip::guard_gone);
  EXPECT_EQ(page->trip, Trip::stale);
}

TEST(GuardPage, WhoMayNotWriteCannot) {
  const auto page = make_guard_page();
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGSEGV, [](int) { ::_exit(7); });
    let_write(*page, false);
    page->pushing = false;
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

}  // namespace
}  // namespace touchstone::hil
