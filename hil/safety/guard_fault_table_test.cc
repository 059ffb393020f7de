// Every fault that a driver, a program or a process of the guard can have, at every state in which it can have it: how
// long until the motors are at zero? The table is docs/explanation/guard.md: this test makes it
// (TOUCHSTONE_HIL_GUARD_TABLE names a file to write it to) and holds faults and reasons against it; times are of the
// machine that wrote it. With real-time scheduling each is held against 20 ms and what the guard's processes waited for
// a processor meanwhile, measured; on a quiet machine TOUCHSTONE_HIL_QUIET=1 holds them against 20 ms alone.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "harness/base/atomic_file.h"
#include "hil/emulators/faulty_device.h"
#include "hil/emulators/guard_lateness.h"
#include "hil/emulators/haptic_emulator.h"
#include "hil/safety/guard_transitions.h"
#include "hil/safety/guardian.h"

namespace touchstone::hil {
namespace {

constexpr double longest_to_zero_s = 0.02;
// A sanitizer makes processes several times slower, and one that crashes writes its report before it ends: what it does
// in its time is held there, not the time, nor which comes first: a program's end or the silence while it ends.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool holds_times = false;
#else
constexpr bool holds_times = true;
#endif

bool real_time(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

// How the test tells the program that pushes what to do.
struct Orders {
  std::atomic<bool> push{false}, end{false}, refused{false};
  std::atomic<double> force_N[3] = {0.0, 0.0, 1.0};
};

GuardOptions options_for(bool timely, std::shared_ptr<GuardPage> page) {
  GuardOptions options;
  options.limits.force_N = 2.0;
  options.limits.slew_N_per_s = 1e4;
  options.limits.workspace_W_m = Box3(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  options.page = std::move(page);
  // Without real-time scheduling a tick may come late by more than the guard's patience without any fault.
  if (!timely) options.limits.stale_s = options.driver_timeout_s = options.watchdog_s = 0.3;
  return options;
}

// The program: pushes at 1 kHz through the guard until told to end; stays alive when the guard lets go.
[[noreturn]] void program(const std::filesystem::path& file, FaultOrders& faults, Orders& orders,
                          const GuardOptions& options) {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  real_time(79);
  MonotonicClock clock;
  try {
    const auto device = open_guarded([&] { return open_faulty_device(file, faults); }, options);
    for (double t = clock.now_s(); !orders.end; t += 1e-3) {
      const Vec3 force(orders.force_N[0], orders.force_N[1], orders.force_N[2]);
      device->exchange(orders.push ? force : Vec3(Vec3::Zero()), clock.now_s() + 1.0);
      clock.sleep_until(t + 1e-3);
    }
    ::_exit(0);
  } catch (const DeviceError&) {
    orders.refused = true;
    while (!orders.end) clock.sleep_until(clock.now_s() + 0.001);
    ::_exit(1);
  }
}

struct Trial {
  std::string fault, state;
  // Set before the device is opened.
  DeviceCall call = DeviceCall::none;
  DriverFault driver_fault = DriverFault::none;
  int times = 1, instance = 1;
  bool at_once = false;  // strikes while opening; else only from when the state is reached
  bool push = true;
  // What the test does when the state is reached.
  std::function<void(pid_t program, GuardPage& page, Orders& orders)> act;
  bool no_fault = false;  // nothing is to happen: the force must stay, or the table shows nothing
  // The driver's process ends. While the system ends it, it is silent: which of both the guard sees first is the
  // system's matter (2 to 7 ms were seen; of silence it lets go after some 7), and the motors are at zero either way.
  bool ends_driver = false;
};

struct TrialOutcome {
  bool reached = false;  // the state
  // The guard let go before any fault struck.
  bool let_go_early = false;
  // It did since the machine left its processes without a processor for longer than their patience, as was measured:
  // the trial shows nothing about its fault.
  bool machine_was_late = false;
  double to_zero_s = -1;
  GuardWaits waits;       // for a processor, before the guard let go early
  double waited_s = 0.0;  // for a processor, the guard's processes together, from the fault to zero
  double most_N = 0.0;    // after the fault struck
  std::string reason;
  bool silence_first = false;  // the program was ended, and the guard let go of its silence before it saw that
  std::string wrong_step;      // in the guard's log, that guard_transitions.h does not allow
};

std::string wrong_step(const std::vector<GuardEvent>& events) {
  GuardPhase now = GuardPhase::opening;
  for (const GuardEvent& event : events) {
    if (event.phase == GuardPhase::opening) continue;  // a process says what it starts without, maybe late
    if (!may_follow(now, event.phase))
      return fmt::format("from {} to {}: {}", to_string(now), to_string(event.phase), event.what);
    now = event.phase;
  }
  return "";
}

class GuardTrial {
 public:
  GuardTrial(const Trial& trial, bool timely) : trial_(trial), timely_(timely) {
    file_ = std::filesystem::temp_directory_path() / fmt::format("touchstone-guard-{}", ::getpid());
    plant_ = std::make_unique<EmulatedHapticPlant>(file_, 0.0);
    void* const memory = ::mmap(nullptr, sizeof(Orders), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    orders_ = new (memory) Orders;
  }
  ~GuardTrial() { ::munmap(orders_, sizeof(Orders)); }
  GuardTrial(const GuardTrial&) = delete;
  GuardTrial& operator=(const GuardTrial&) = delete;

  TrialOutcome go() {
    if (trial_.at_once) arm();
    const auto options = options_for(timely_, page_);
    const pid_t program_pid = ::fork();
    if (program_pid == 0) program(file_, *faults_, *orders_, options);
    lateness_ = std::make_unique<GuardLateness>(program_pid, *page_);
    TrialOutcome outcome;
    orders_->push = trial_.push;
    const auto in_state = [&] {
      return trial_.at_once || (trial_.push ? plant_->applied_N().norm() > 0.9 : plant_->commands() > 20);
    };
    wait_for([&] { return in_state() || page_->trip != Trip::none; });
    outcome.reached = in_state();
    if (!outcome.reached || (!trial_.at_once && page_->trip != Trip::none)) {
      judge_early(outcome, options);
      end(program_pid);
      return outcome;
    }
    double from = clock_.now_s();
    if (!trial_.at_once && trial_.call != DeviceCall::none) arm();
    if (trial_.act) trial_.act(program_pid, *page_, *orders_);
    const bool by_driver = !trial_.act && trial_.call != DeviceCall::none;
    if (by_driver && wait_for([&] { return faults_->struck_s > 0.0; })) from = faults_->struck_s;
    // Where no force is on, the program is told at most that something is wrong.
    if (trial_.at_once || !trial_.push) wait_for([&] { return orders_->refused.load(); }, 2.0);
    const double until = clock_.now_s() + (trial_.no_fault ? 0.2 : trial_.push ? 5.0 : 0.05);
    for (;;) {
      const double force = plant_->applied_N().norm();
      outcome.most_N = std::max(outcome.most_N, force);
      if (force == 0.0 && (trial_.push || trial_.at_once)) {
        outcome.to_zero_s = std::max(0.0, clock_.now_s() - from);
        outcome.waited_s = lateness_->since(from).processes_s();
        break;
      }
      if (clock_.now_s() > until) break;
      rest();
      if (!trial_.push) outcome.to_zero_s = 0.0;
    }
    // The log's last word may come after the zero.
    const bool stays_on = trial_.no_fault && outcome.to_zero_s < 0.0;
    wait_for([&] { return page_->phase == GuardPhase::off || stays_on || !trial_.push || trial_.at_once; }, 0.5);
    outcome.reason =
        page_->trip == Trip::none ? (orders_->refused ? "refused" : "-") : std::string(to_string(page_->trip));
    if (page_->trip == Trip::stale) outcome.silence_first = wait_for([&] { return was_killed(program_pid); }, 0.1);
    // Zero must stay zero.
    if (outcome.to_zero_s >= 0.0 && plant_->applied_N().norm() > 0.0) outcome.to_zero_s = -1;
    if (trial_.no_fault && page_->trip != Trip::none) judge_early(outcome, options);
    end(program_pid);
    outcome.wrong_step = wrong_step(page_->events());
    return outcome;
  }

 private:
  void arm() {
    faults_->fault = trial_.driver_fault;
    faults_->times = trial_.times;
    faults_->instance = trial_.instance;
    faults_->call = trial_.call;
  }
  template <class Condition>
  bool wait_for(const Condition& condition, double within_s = 20.0) {
    for (const double until = clock_.now_s() + within_s; clock_.now_s() < until;) {
      if (condition()) return true;
      rest();
    }
    return false;
  }
  // Ended by a signal; it stays to be waited for.
  static bool was_killed(pid_t pid) {
    siginfo_t info{};
    return ::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid &&
           info.si_code == CLD_KILLED;
  }
  void rest() {
    const double due = clock_.now_s() + 2e-4;
    clock_.sleep_until(due);
    lateness_->look(due);
  }
  void judge_early(TrialOutcome& outcome, const GuardOptions& options) {
    const Trip trip = page_->trip;
    outcome.let_go_early = trip != Trip::none;
    const double from = clock_.now_s() - patience_of(trip, options) - usual_silence_s;
    wait_for([] { return false; }, 0.005);  // the kernel adds a wait when it ends
    outcome.waits = lateness_->since(from);
    outcome.machine_was_late = explains(outcome.waits, trip, options);
    outcome.reason = std::string(to_string(trip));
  }
  void end(pid_t program_pid) {
    orders_->end = true;
    ::kill(program_pid, SIGCONT);
    for (int i = 0; i < 3000 && ::waitpid(program_pid, nullptr, WNOHANG) == 0; ++i) {
      if (i == 2500) ::kill(program_pid, SIGKILL);
      clock_.sleep_until(clock_.now_s() + 0.001);
    }
    // Processes that the trial stopped or that block for ever, each by its own number: those that never went away.
    for (const int pid : {page_->guard_pid.load(), page_->driver_pid.load(), page_->rescuer_pid.load()}) {
      if (pid > 0 && !wait_for([&] { return ::kill(pid, 0) != 0; }, 0.2)) ::kill(pid, SIGKILL);
    }
  }

  const Trial& trial_;
  bool timely_;
  std::filesystem::path file_;
  std::unique_ptr<EmulatedHapticPlant> plant_;
  std::shared_ptr<FaultOrders> faults_ = make_fault_orders();
  std::shared_ptr<GuardPage> page_ = make_guard_page();
  Orders* orders_ = nullptr;
  std::unique_ptr<GuardLateness> lateness_;
  MonotonicClock clock_;
};

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

// Done again where the machine was late, as measured: a loaded machine may be, a few times, and then says so. A guard
// that lets go by itself, with no such wait, fails at once.
TrialOutcome go(const Trial& trial, bool timely, int& late) {
  constexpr int most_attempts = 4;
  for (int attempt = 1;; ++attempt) {
    TrialOutcome outcome = GuardTrial(trial, timely).go();
    if (!outcome.machine_was_late || attempt == most_attempts) return outcome;
    ++late;
  }
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
      if (timely && holds_times) {
        EXPECT_LE(outcome.to_zero_s, longest_to_zero_s + outcome.waited_s);
      }
    }
    const bool never_on = !trial.push || trial.at_once;
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
