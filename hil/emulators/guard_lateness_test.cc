#include "emulators/guard_lateness.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

namespace touchstone::hil {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

GuardWaits waits(double program_s, double guard_s, double driver_s, double rescuer_s = 0.0, double watcher_s = 0.0) {
  return {program_s, guard_s, driver_s, rescuer_s, watcher_s};
}

// The usual patience: 10 ms for a command, 6 ms for the driver, 8 ms for the guard; 2 ms pass anyway.
TEST(GuardLateness, OnlyWaitsAsLongAsTheStatedSilenceExplainIt) {
  const GuardOptions usual;
  EXPECT_FALSE(explains(waits(0, 0, 0), Trip::stale, usual));
  EXPECT_FALSE(explains(waits(0.0079, 0, 0), Trip::stale, usual));
  EXPECT_TRUE(explains(waits(0.0081, 0, 0), Trip::stale, usual));
  EXPECT_TRUE(explains(waits(0.003, 0.003, 0.003), Trip::stale, usual)) << "one after the other";
  EXPECT_FALSE(explains(waits(0, 0.0039, 0), Trip::driver_silent, usual));
  EXPECT_TRUE(explains(waits(0, 0.0021, 0.0021), Trip::driver_silent, usual));
  EXPECT_FALSE(explains(waits(0, 0.0059, 0), Trip::guard_gone, usual));
  EXPECT_TRUE(explains(waits(0, 0.0061, 0), Trip::guard_gone, usual));
  EXPECT_FALSE(explains(waits(0, 0, 0, 0.0059), Trip::watchdog_gone, usual));
  EXPECT_TRUE(explains(waits(0, 0, 0, 0.0061), Trip::watchdog_gone, usual));
}

TEST(GuardLateness, WaitsOfAProcessThatTheReasonDoesNotRestOnExplainNothing) {
  const GuardOptions usual;
  EXPECT_FALSE(explains(waits(1, 0, 0), Trip::driver_silent, usual));
  EXPECT_FALSE(explains(waits(1, 0, 1, 1), Trip::guard_gone, usual));
  EXPECT_FALSE(explains(waits(0, 0, 0, 1), Trip::stale, usual));
}

TEST(GuardLateness, AReasonThatIsNoSilenceIsNeverExplained) {
  const GuardOptions usual;
  for (const Trip trip : {Trip::none, Trip::force, Trip::not_finite, Trip::device_error, Trip::client_gone,
                          Trip::driver_gone, Trip::zero_not_confirmed})
    EXPECT_FALSE(explains(waits(1, 1, 1, 1, 1), trip, usual)) << to_string(trip);
}

TEST(GuardLateness, AWaitThatWasNotMeasuredExplainsNothing) {
  const GuardOptions usual;
  for (const Trip trip : {Trip::stale, Trip::driver_silent, Trip::guard_gone})
    EXPECT_FALSE(explains(waits(nan, nan, nan, nan), trip, usual)) << to_string(trip);
}

TEST(GuardLateness, AWatcherAboveAllThatIsLateItselfExplains) {
  EXPECT_TRUE(explains(waits(0, 0, 0, 0, 0.0061), Trip::guard_gone, GuardOptions()));
  EXPECT_FALSE(explains(waits(0, 0, 0, 0, 0.0059), Trip::guard_gone, GuardOptions()));
}

TEST(GuardLateness, ALongerPatienceNeedsLongerWaits) {
  GuardOptions patient;
  patient.watchdog_s = 0.3;
  EXPECT_FALSE(explains(waits(0, 0.2, 0), Trip::guard_gone, patient));
  EXPECT_TRUE(explains(waits(0, 0.299, 0), Trip::guard_gone, patient));
}

int start(const std::function<void()>& life) {
  const int pid = ::fork();
  if (pid == 0) {
    life();
    ::_exit(0);
  }
  return pid;
}

void compute_for_ever() {
  for (volatile double x = 0.0;;) x = x + 1.0;
}

// R, S, T ...: the third field of /proc/PID/stat (proc_pid_stat(5)), after the name in brackets.
char state_of(int pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string text;
  std::getline(file, text);
  const auto end = text.rfind(')');
  return end == std::string::npos || end + 2 >= text.size() ? '?' : text[end + 2];
}

// What the kernel counts: two that compute on one processor wait for each other; who sleeps or is stopped waits for
// none.
TEST(GuardLateness, CountsWhoIsReadyAndHasNoProcessor) {
  cpu_set_t mine;
  ASSERT_EQ(::sched_getaffinity(0, sizeof mine, &mine), 0);
  int cpu = 0;
  while (!CPU_ISSET(cpu, &mine)) ++cpu;
  const auto on_that_cpu = [cpu] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(cpu, &one);
    ::sched_setaffinity(0, sizeof one, &one);
    compute_for_ever();
  };
  const auto page = make_guard_page();
  const int rival = start(on_that_cpu), stopped = start(on_that_cpu), asleep = start([] { ::pause(); });
  page->guard_pid = start(on_that_cpu);
  page->driver_pid = asleep;
  page->rescuer_pid = stopped;
  GuardLateness lateness(rival, *page);
  MonotonicClock clock;
  ::kill(stopped, SIGSTOP);
  // A process that is to sleep or to stop waits once more for a processor to do so.
  for (const double until = clock.now_s() + 20.0; clock.now_s() < until;) {
    if (state_of(stopped) == 'T' && state_of(asleep) == 'S') break;
    clock.sleep_until(clock.now_s() + 0.005);
  }
  ASSERT_EQ(state_of(stopped), 'T');
  ASSERT_EQ(state_of(asleep), 'S');
  lateness.look(clock.now_s());
  const double from = clock.now_s();
  clock.sleep_until(from + 0.3);
  lateness.look(from + 0.3);
  const GuardWaits waited = lateness.since(from);
  for (const int pid : {rival, stopped, asleep, page->guard_pid.load()}) {
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
  }
  // Of 0.3 s each of the two can have all but what the other has; the kernel divides them fairly within some ticks.
  EXPECT_GT(waited.guard_s, 0.05);
  EXPECT_GT(waited.program_s, 0.05);
  EXPECT_EQ(waited.driver_s, 0.0);
  EXPECT_EQ(waited.rescuer_s, 0.0);
}

TEST(GuardLateness, AProcessThatIsNotThereIsNotMeasured) {
  const auto page = make_guard_page();
  GuardLateness lateness(0, *page);
  lateness.look(MonotonicClock().now_s());
  EXPECT_FALSE(explains(lateness.since(0.0), Trip::stale, GuardOptions()));
}

}  // namespace
}  // namespace touchstone::hil
