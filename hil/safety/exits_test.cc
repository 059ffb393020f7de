// Every way out of a program that pushes: does the device end at zero force, and how soon?
//   guardian: the guardian process alone, on a device without a watchdog.
//   watchdog: the device's own watchdog alone.
//   scope:    the guard of the C++ scope alone; it covers what returns, and nothing else: the table says so.
//   none:     nothing at all; the force must stay, or this test could not fail.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "emulators/haptic_emulator.h"

namespace touchstone::hil {
namespace {

const std::vector<std::string>& ways() {
  static const std::vector<std::string> list{
      "return", "exception", "uncaught exception", "exit", "SIGINT", "SIGTERM", "abort",
      "SEGV",   "SIGKILL",   "hung loop"};
  return list;
}

struct Outcome {
  bool pushed = false;       // it did push before
  double zero_after_s = -1;  // from its end (or hang); negative: still pushing half a second later
};

Outcome end_by(const std::string& way, const std::string& guard, double watchdog_s) {
  const auto file = std::filesystem::temp_directory_path() / fmt::format("touchstone-exit-{}-{}", ::getpid(), guard);
  EmulatedHapticPlant plant(file, watchdog_s);
  int in[2];
  if (::pipe2(in, O_CLOEXEC) != 0) return {};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  // A runner may ignore signals, and its children inherit that: here they mean what they mean at a terminal.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults, none;
  sigemptyset(&defaults);
  sigemptyset(&none);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&defaults, signal);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  const char* const arguments[] = {TOUCHSTONE_EXIT_VICTIM, file.c_str(), way.c_str(), guard.c_str(), nullptr};
  pid_t victim = 0;
  const int spawned =
      ::posix_spawn(&victim, TOUCHSTONE_EXIT_VICTIM, &actions, &attributes, const_cast<char**>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(in[0]);
  if (spawned != 0) return {};
  MonotonicClock clock;
  Outcome outcome;
  // Until it pushes; every wait here has an end.
  for (const double until = clock.now_s() + 20.0; clock.now_s() < until && !outcome.pushed;) {
    outcome.pushed = plant.applied_N().norm() > 0.0;
    clock.sleep_until(clock.now_s() + 0.0005);
  }
  [[maybe_unused]] const auto told = ::write(in[1], "!", 1);
  if (way == "SIGINT") ::kill(victim, SIGINT);
  if (way == "SIGTERM") ::kill(victim, SIGTERM);
  double ended = 0.0;
  const double give_up = clock.now_s() + 10.0;
  if (way == "hung loop") {
    // It hangs once commands stop coming.
    std::uint64_t last = plant.commands();
    double since = clock.now_s();
    while (clock.now_s() < give_up && clock.now_s() - since < 0.01) {
      if (plant.commands() != last) last = plant.commands(), since = clock.now_s();
      clock.sleep_until(clock.now_s() + 0.001);
    }
    ended = since;
  } else {
    int status = 0;
    while (::waitpid(victim, &status, WNOHANG) == 0 && clock.now_s() < give_up)
      clock.sleep_until(clock.now_s() + 0.0005);
    ended = clock.now_s();
  }
  while (clock.now_s() < ended + 0.5) {
    if (plant.applied_N().norm() == 0.0) {
      outcome.zero_after_s = std::max(0.0, clock.now_s() - ended);
      break;
    }
    clock.sleep_until(clock.now_s() + 0.001);
  }
  ::kill(victim, SIGKILL);
  ::waitpid(victim, nullptr, 0);
  ::close(in[1]);
  return outcome;
}

std::string cell(const Outcome& o) {
  return o.zero_after_s < 0 ? "STAYS" : fmt::format("{:.0f} ms", 1e3 * o.zero_after_s);
}

TEST(Exits, TheGuardianBringsTheDeviceToZeroHoweverTheProgramEnds) {
  for (const auto& way : ways()) {
    const auto outcome = end_by(way, "guardian", 0.0);
    fmt::print("guardian  {:<20} {}\n", way, cell(outcome));
    EXPECT_TRUE(outcome.pushed) << way;
    EXPECT_GE(outcome.zero_after_s, 0.0) << way << ": still pushing half a second later";
  }
}

TEST(Exits, TheDevicesWatchdogDoesToo) {
  for (const auto& way : ways()) {
    const auto outcome = end_by(way, "none", 0.05);
    fmt::print("watchdog  {:<20} {}\n", way, cell(outcome));
    EXPECT_TRUE(outcome.pushed) << way;
    EXPECT_GE(outcome.zero_after_s, 0.0) << way;
  }
}

TEST(Exits, TheScopesGuardCoversWhatReturnsAndNoMore) {
  for (const auto& way : ways()) {
    const auto outcome = end_by(way, "scope", 0.0);
    fmt::print("scope     {:<20} {}\n", way, cell(outcome));
    EXPECT_TRUE(outcome.pushed) << way;
    const bool covered = way == "return" || way == "exception" || way == "SIGINT" || way == "SIGTERM";
    EXPECT_EQ(outcome.zero_after_s >= 0.0, covered) << way;
  }
}

TEST(Exits, WithoutAnyGuardTheForceStaysSoTheseTestsCanFail) {
  for (const auto& way : {"return", "SIGKILL", "hung loop"}) {
    const auto outcome = end_by(way, "none", 0.0);
    fmt::print("none      {:<20} {}\n", way, cell(outcome));
    EXPECT_TRUE(outcome.pushed) << way;
    EXPECT_LT(outcome.zero_after_s, 0.0) << way;
  }
}

}  // namespace
}  // namespace touchstone::hil
