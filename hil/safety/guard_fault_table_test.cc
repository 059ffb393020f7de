// Every fault that a driver, a program or a process of the guard can have, at every state in which it can have it: how
// long until the motors are at zero? The table is docs/explanation/guard.md: this test makes it
// (TOUCHSTONE_HIL_GUARD_TABLE names a file to write it to) and holds faults and reasons against it; times are of the
// machine that wrote it. With real-time scheduling each is held against 20 ms and what the guard's processes waited for
// a processor meanwhile, measured; on a quiet machine TOUCHSTONE_HIL_QUIET=1 holds them against 20 ms alone.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "harness/base/atomic_file.h"
#include "safety/guard_trial.h"

namespace touchstone::hil {
namespace {

void add_driver_faults(std::vector<Trial>& trials) {
  using C = DeviceCall;
  using F = DriverFault;
  const std::pair<F, const char*> everywhere[] = {
      {F::device_error, "an error"}, {F::out_of_memory, "bad_alloc"}, {F::not_exception, "an int is thrown"},
      {F::blocks, "never returns"},  {F::late, "50 ms late"},         {F::aborts, "the process dies"}};
  for (const auto& [fault, words] : everywhere) {
    if (fault != F::blocks && fault != F::late) {
      trials.push_back({fmt::format("open: {}", words), "opening", C::open, fault, 1, 1, true, true, {}, false});
    }
    trials.push_back(
        {fmt::format("exchange: {}", words), "at zero", C::exchange, fault, 1, 1, false, false, {}, false});
    trials.push_back({fmt::format("exchange: {}", words), "pushing", C::exchange, fault, 1, 1, false, true, {}, false});
    trials.push_back(
        {fmt::format("calibrated: {}", words), "pushing", C::calibrated, fault, 1, 1, false, true, {}, false});
    for (Trial* const pushing : {&trials[trials.size() - 2], &trials.back()}) pushing->ends_driver = fault == F::aborts;
  }
  for (const auto& [fault, words] : {std::pair{F::not_finite, "a position that is no number"},
                                     {F::frozen, "a state of a second ago"},
                                     {F::out_of_reach, "a position out of the workspace"}}) {
    trials.push_back({fmt::format("exchange: {}", words), "pushing", C::exchange, fault, 1, 1, false, true, {}, false});
  }
  const auto kill_program = [](pid_t program, GuardPage&, Orders&) { ::kill(program, SIGKILL); };
  for (const auto& [call, name] : {std::pair{C::zero_force, "zero"}, {C::motors_off, "motors off"}}) {
    for (const auto& [fault, words] : {std::pair{F::refuses, "refused once"},
                                       {F::blocks, "never returns"},
                                       {F::aborts, "the process dies"},
                                       {F::out_of_memory, "bad_alloc (ends the process)"}}) {
      trials.push_back(
          {fmt::format("{}: {}", name, words), "letting go", call, fault, 1, 1, false, true, kill_program, false});
    }
    trials.push_back({fmt::format("{}: always refused by this driver", name), "letting go", call, F::refuses, -1, 1,
                      false, true, kill_program, false});
  }
  trials.push_back(
      {"close: never returns", "letting go", C::close, F::blocks, -1, 1, false, true, kill_program, false});
}

void add_process_faults(std::vector<Trial>& trials) {
  const auto signal_to = [](std::atomic<int> GuardPage::*whom, int signal) {
    return [whom, signal](pid_t, GuardPage& page, Orders&) { ::kill(page.*whom, signal); };
  };
  const auto add = [&](const char* fault, std::function<void(pid_t, GuardPage&, Orders&)> act, DeviceCall call = {},
                       DriverFault driver = {}, int times = 0) {
    trials.push_back({fault, "pushing", call, driver, times, 1, false, true, std::move(act), false});
  };
  const auto hang = [](pid_t program, GuardPage&, Orders&) { ::kill(program, SIGSTOP); };
  const auto command = [](double x, double y, double z) {
    return
        [=](pid_t, GuardPage&, Orders& orders) { orders.force_N[0] = x, orders.force_N[1] = y, orders.force_N[2] = z; };
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  add("the program is killed", [](pid_t program, GuardPage&, Orders&) { ::kill(program, SIGKILL); });
  add("the program hangs", hang);
  add("the program ends", [](pid_t, GuardPage&, Orders& orders) { orders.end = true; });
  add("the program commands 1e6 N", command(0, 0, 1e6));
  add("the program commands (NaN, 5, 0) N", command(nan, 5, 0));
  add("the program hangs, and one zero is refused", hang, DeviceCall::zero_force, DriverFault::refuses, 1);
  add("the guard is killed", signal_to(&GuardPage::guard_pid, SIGKILL));
  add("the guard is stopped", signal_to(&GuardPage::guard_pid, SIGSTOP));
  add("the guard crashes", signal_to(&GuardPage::guard_pid, SIGSEGV));
  add("the driver is killed", signal_to(&GuardPage::driver_pid, SIGKILL));
  trials.back().ends_driver = true;
  add("the driver is stopped", signal_to(&GuardPage::driver_pid, SIGSTOP));
  add("the rescuer is killed", signal_to(&GuardPage::rescuer_pid, SIGKILL));
  for (const int signal : {SIGKILL, SIGSTOP}) {
    const char* const what = signal == SIGKILL ? "killed" : "stopped";
    trials.push_back({fmt::format("the driver blocks and the guard is {}", what), "pushing", DeviceCall::none,
                      DriverFault::none, 0, 1, false, true,
                      [signal](pid_t, GuardPage& page, Orders&) {
                        ::kill(page.driver_pid, SIGSTOP);
                        ::kill(page.guard_pid, signal);
                      },
                      false});
  }
  add("the driver is killed, and opening anew fails once", signal_to(&GuardPage::driver_pid, SIGKILL), DeviceCall::open,
      DriverFault::device_error, 1);
  trials.back().instance = 2;
  trials.back().ends_driver = true;
  trials.push_back({"none", "pushing", DeviceCall::none, DriverFault::none, 0, 1, false, true, {}, true});
}

std::string row_start(const Trial& trial, const TrialOutcome& outcome) {
  return fmt::format("| {} | {} | {} | ", trial.fault, trial.state, outcome.reason);
}

TEST(GuardFaultTable, IsTheOneInTheDocumentation) {
  std::vector<Trial> trials;
  add_driver_faults(trials);
  add_process_faults(trials);
  sched_param before{};
  const int policy = ::sched_getscheduler(0);
  ::sched_getparam(0, &before);
  const bool timely = real_time(83);
  std::string table =
      "| fault | while | what the guard states | zero after | waited for a processor |\n|---|---|---|---|---|\n";
  std::vector<std::string> starts;
  double worst_s = 0.0;
  int late = 0;
  for (const Trial& trial : trials) {
    const TrialOutcome outcome = go(trial, timely, late);
    SCOPED_TRACE(trial.fault + ", " + trial.state);
    const bool never_on = !trial.push || trial.at_once;
    EXPECT_TRUE(outcome.reached);
    EXPECT_FALSE(outcome.let_go_early) << fmt::format(
        "it let go before any fault: {}; waited for a processor before: program {:.1f} ms, guard "
        "{:.1f} ms, driver {:.1f} ms; the watcher was late by {:.1f} ms",
        outcome.reason, 1e3 * outcome.waits.program_s, 1e3 * outcome.waits.guard_s, 1e3 * outcome.waits.driver_s,
        1e3 * outcome.waits.watcher_s);
    EXPECT_EQ(outcome.wrong_step, "");
    EXPECT_LE(outcome.most_N, 2.0 + 1e-9) << "more than the limit reached the motors";
    if (trial.no_fault) {
      EXPECT_LT(outcome.to_zero_s, 0.0) << "the force must stay, or this table shows nothing";
      EXPECT_EQ(outcome.reason, "-");
    } else {
      EXPECT_GE(outcome.to_zero_s, 0.0) << "a force stays on";
      worst_s = std::max(worst_s, outcome.to_zero_s);
      if (timely && holds_times && !never_on) {
        EXPECT_LE(outcome.to_zero_s, longest_to_zero_s + outcome.waited_s);
      }
    }
    const std::string start = row_start(trial, outcome);
    const bool driver_silent_first = trial.ends_driver && outcome.reason == to_string(Trip::driver_silent);
    if ((holds_times || !outcome.silence_first) && !driver_silent_first) starts.push_back(start);
    table += start +
             (trial.no_fault ? "stays on | -"
              : never_on     ? "never on | -"
                             : fmt::format("{:.1f} ms | {:.1f} ms", 1e3 * outcome.to_zero_s, 1e3 * outcome.waited_s)) +
             " |\n";
  }
  ::sched_setscheduler(0, policy, &before);
  fmt::print(
      "{}emulated: {} faults, worst time to zero {:.1f} ms, {} real-time scheduling, {} trials done again since "
      "the machine was late before the fault, as measured\n",
      table, trials.size() - 1, 1e3 * worst_s, timely ? "with" : "without", late);
  const char* const quiet = std::getenv("TOUCHSTONE_HIL_QUIET");
  if (quiet != nullptr && std::string(quiet) == "1") {
    EXPECT_LE(worst_s, longest_to_zero_s);
    EXPECT_EQ(late, 0);
  }
  if (const char* const file = std::getenv("TOUCHSTONE_HIL_GUARD_TABLE")) write_file(file, table);
  const auto documented =
      read_file(std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "docs" / "explanation" / "guard.md");
  for (const auto& start : starts) EXPECT_THAT(documented, ::testing::HasSubstr(start));
}

// The rule by which a trial is excused, on guards that let go without a fault of their own.
class GuardExcuse : public ::testing::Test {
 protected:
  void SetUp() override {
    policy_ = ::sched_getscheduler(0);
    ::sched_getparam(0, &before_);
    if (!real_time(watcher_priority)) GTEST_SKIP() << "needs real-time scheduling";
  }
  void TearDown() override { ::sched_setscheduler(0, policy_, &before_); }

  static TrialOutcome without_fault(std::function<void(pid_t, GuardPage&, Orders&)> act) {
    Trial trial;
    trial.fault = "none";
    trial.no_fault = true;
    trial.act = std::move(act);
    return GuardTrial(trial, true).go();
  }

  static constexpr int watcher_priority = 95, hog_priority = 90;  // the guard's own are 79 to 82
  int policy_ = SCHED_OTHER;
  sched_param before_{};
};

TEST_F(GuardExcuse, ProcessesThatStarveExcuseTheTrial) {
  std::vector<pid_t> hogs;
  const TrialOutcome outcome = without_fault([&](pid_t, GuardPage&, Orders&) {
    cpu_set_t mine;
    ::sched_getaffinity(0, sizeof mine, &mine);
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      if (!CPU_ISSET(cpu, &mine)) continue;
      hogs.push_back(::fork());
      if (hogs.back() != 0) continue;
      cpu_set_t one;
      CPU_ZERO(&one);
      CPU_SET(cpu, &one);
      ::sched_setaffinity(0, sizeof one, &one);
      real_time(hog_priority);
      MonotonicClock clock;
      for (const double until = clock.now_s() + 0.03; clock.now_s() < until;) {
      }
      ::_exit(0);
    }
  });
  for (const pid_t hog : hogs) ::waitpid(hog, nullptr, 0);
  EXPECT_TRUE(outcome.reached);
  EXPECT_TRUE(outcome.let_go_early) << "a guard that gets no processor for 30 ms lets go";
  EXPECT_TRUE(outcome.machine_was_late) << outcome.reason << ": " << outcome.waits.guard_s << " s of the guard";
}

TEST_F(GuardExcuse, AGuardThatDoesNotRunByItselfIsNotExcused) {
  const TrialOutcome outcome = without_fault([](pid_t, GuardPage& page, Orders&) { ::kill(page.guard_pid, SIGSTOP); });
  EXPECT_TRUE(outcome.reached);
  EXPECT_TRUE(outcome.let_go_early);
  EXPECT_EQ(outcome.reason, to_string(Trip::guard_gone));
  EXPECT_FALSE(outcome.machine_was_late);
}

TEST_F(GuardExcuse, ASecondWatchdogThatDiesIsNotExcused) {
  const TrialOutcome outcome =
      without_fault([](pid_t, GuardPage& page, Orders&) { ::kill(page.rescuer_pid, SIGKILL); });
  EXPECT_TRUE(outcome.let_go_early);
  EXPECT_EQ(outcome.reason, to_string(Trip::watchdog_gone));
  EXPECT_FALSE(outcome.machine_was_late);
}

}  // namespace
}  // namespace touchstone::hil
