// A guard tried with a fault: a program that pushes through a guard an emulated device that holds a force for ever and
// has no watchdog of its own; what strikes it, and how long until the motors are at zero. For guard_fault_table_test.cc
// and guard_pairs_test.cc.
#pragma once

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

#include "emulators/faulty_device.h"
#include "emulators/guard_lateness.h"
#include "emulators/haptic_emulator.h"
#include "harness/base/atomic_file.h"
#include "safety/guard_transitions.h"
#include "safety/guardian.h"

namespace touchstone::hil {

inline constexpr double longest_to_zero_s = 0.02;
// A sanitizer makes processes several times slower, and one that crashes writes its report before it ends: what it does
// in its time is held there, not the time, nor which comes first: a program's end or the silence while it ends.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool holds_times = false;
#else
inline constexpr bool holds_times = true;
#endif

inline bool real_time(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

// How the test tells the program that pushes what to do.
struct Orders {
  std::atomic<bool> push{false}, end{false}, refused{false};
  std::atomic<double> force_N[3] = {0.0, 0.0, 1.0};
};

inline GuardOptions options_for(bool timely, std::shared_ptr<GuardPage> page) {
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
[[noreturn]] inline void program(const std::filesystem::path& file, FaultOrders& faults, Orders& orders,
                                 const GuardOptions& options, double deadline_s) {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  real_time(79);
  MonotonicClock clock;
  try {
    const auto device = open_guarded([&] { return open_faulty_device(file, faults); }, options);
    for (double t = clock.now_s(); !orders.end; t += 1e-3) {
      const Vec3 force(orders.force_N[0], orders.force_N[1], orders.force_N[2]);
      device->exchange(orders.push ? force : Vec3(Vec3::Zero()), clock.now_s() + deadline_s);
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
  // Of the device, from the start.
  bool one_owner = false;
  double deadline_s = 1.0;  // of the program's exchanges
  double open_takes_s = 0.0;
  // Two faults: the second strikes so long after the first, from when on the time to zero runs. Such a trial ends by
  // ending every process, whatever it still waits for.
  bool pair = false;
  double second_after_s = 0.0;
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

inline std::string wrong_step(const std::vector<GuardEvent>& events) {
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
  GuardTrial(const Trial& trial, bool timely, uid_t user = ::getuid()) : trial_(trial), timely_(timely), user_(user) {
    static int made = 0;  // a device of its own: one that is still being brought to rest is locked
    file_ = std::filesystem::temp_directory_path() / fmt::format("touchstone-guard-{}-{}", ::getpid(), ++made);
    plant_ = std::make_unique<EmulatedHapticPlant>(file_, 0.0);
    std::filesystem::permissions(file_, std::filesystem::perms(0666));
    void* const memory = ::mmap(nullptr, sizeof(Orders), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    orders_ = new (memory) Orders;
  }
  ~GuardTrial() { ::munmap(orders_, sizeof(Orders)); }
  GuardTrial(const GuardTrial&) = delete;
  GuardTrial& operator=(const GuardTrial&) = delete;

  TrialOutcome go() {
    if (trial_.at_once) arm();
    faults_->one_owner = trial_.one_owner;
    faults_->open_takes_s = trial_.open_takes_s;
    const auto options = options_for(timely_, page_);
    const pid_t program_pid = ::fork();
    if (program_pid == 0) {
      if (!become(user_)) ::_exit(9);
      program(file_, *faults_, *orders_, options, trial_.deadline_s);
    }
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
    from += trial_.second_after_s;
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
    // The log's last word may come after the zero; none comes where the driver alone is left.
    const bool stays_on = trial_.no_fault && outcome.to_zero_s < 0.0;
    wait_for([&] { return page_->phase == GuardPhase::off || stays_on || !trial_.push || trial_.at_once; },
             trial_.pair ? 0.02 : 0.5);
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
    const double let_go_s = page_->tripped_s > 0.0 ? page_->tripped_s.load() : clock_.now_s();
    const double from = let_go_s - patience_of(trip, options) - usual_silence_s;
    wait_for([] { return false; }, 0.005);  // the kernel adds a wait when it ends
    outcome.waits = lateness_->since(from);
    outcome.machine_was_late = explains(outcome.waits, trip, options);
    outcome.reason = std::string(to_string(trip));
  }
  void end(pid_t program_pid) {
    if (trial_.pair) {
      for (const int pid :
           {page_->driver_pid.load(), page_->rescuer_pid.load(), page_->guard_pid.load(), program_pid}) {
        if (pid > 0) ::kill(pid, SIGKILL);
      }
      ::waitpid(program_pid, nullptr, 0);
      return;
    }
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

  static bool become(uid_t user) {
    return user == ::getuid() || (::setresgid(user, user, user) == 0 && ::setresuid(user, user, user) == 0);
  }

  const Trial& trial_;
  bool timely_;
  uid_t user_;
  std::filesystem::path file_;
  std::unique_ptr<EmulatedHapticPlant> plant_;
  std::shared_ptr<FaultOrders> faults_ = make_fault_orders();
  std::shared_ptr<GuardPage> page_ = make_guard_page();
  Orders* orders_ = nullptr;
  std::unique_ptr<GuardLateness> lateness_;
  MonotonicClock clock_;
};

// Done again where the machine was late, as measured: a loaded machine may be, a few times, and then says so. A guard
// that lets go by itself, with no such wait, fails at once.
inline TrialOutcome go(const Trial& trial, bool timely, int& late, uid_t user = ::getuid()) {
  constexpr int most_attempts = 4;
  for (int attempt = 1;; ++attempt) {
    TrialOutcome outcome = GuardTrial(trial, timely, user).go();
    if (!outcome.machine_was_late || attempt == most_attempts) return outcome;
    ++late;
  }
}

}  // namespace touchstone::hil
