#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <ctime>

#include "devices/device_lock.h"
#include "safety/guard_messages.h"
#include "safety/guard_processes.h"
#include "safety/harden.h"
#include "safety/rescue.h"

namespace touchstone::hil {
namespace {

constexpr int guard_priority = 81;
constexpr double beat_s = 0.002;  // at least so often while a force is on: a quarter of watchdog_s
constexpr double beat_idle_s = 0.02;
constexpr double rescue_step_s = 5e-4;
constexpr double zero_answer_s = 0.003;   // a living driver answers a zero within this
constexpr int most_zeros = 5;             // that the device may refuse before it is opened anew
constexpr double rescue_answer_s = 0.05;  // then the guard serves the program again; the rescuer goes on
constexpr double farewell_s = 1.0;

class Guard {
 public:
  Guard(int client, int driver, int rescuer, const OpenDevice& open, const GuardOptions& options, GuardPage& page,
        bool calibrated)
      : client_(client),
        driver_(driver),
        rescuer_(rescuer),
        options_(options),
        page_(page),
        supervisor_(limits()),
        driver_process_(page.driver_pid),
        rescue_(Watchman::guard, open, page, options.watchdog_s),
        calibrated_(calibrated) {
    enter(GuardPhase::at_zero, Trip::none, "the device is open");
  }

  void serve() {
    for (;;) {
      beat();
      const bool rescuing = rescue_.begun() && !rescue_.step();
      const double now = clock_.now_s();
      double wait = pushing() ? std::min(beat_s, last_command_s_ + options_.limits.stale_s - now) : beat_idle_s;
      wait = rescuing ? rescue_step_s : std::max(0.0, wait);
      const timespec time{0, static_cast<long>(wait * 1e9)};
      pollfd ready[2] = {{client_, POLLIN, 0}, {tripped() == Trip::none ? rescuer_ : -1, 0, 0}};
      ::ppoll(ready, 2, &time, nullptr);
      if ((ready[1].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) {
        let_go(Trip::watchdog_gone, "the rescuer is gone");
      } else if (pushing()) {
        hold_rescuer_to_its_beat();
      }
      if (ready[0].revents != 0) {
        GuardRequest request;
        if (receive_message(client_, request, clock_.now_s()) == Received::gone || request.ask == GuardAsk::end) break;
        GuardReply reply = answer(request);
        reply.number = request.number;
        reply.trip = tripped();
        if (!send_message(client_, reply)) break;
      } else if (pushing() && tripped() == Trip::none && clock_.now_s() - last_command_s_ >= options_.limits.stale_s) {
        let_go(Trip::stale, "no command came in time");
      }
    }
    farewell();
  }

 private:
  SafetyLimits limits() const {
    SafetyLimits limits = options_.limits;
    limits.ramp_down_s = 0.0;
    return limits;
  }
  [[nodiscard]] bool pushing() const { return page_.pushing; }
  [[nodiscard]] Trip tripped() const { return page_.trip; }
  void beat() { page_.guard_beat_s = clock_.now_s(); }
  void enter(GuardPhase phase, Trip reason, const char* what) {
    page_.phase = phase;
    page_.log(clock_.now_s(), phase, reason, what);
  }

  void hold_rescuer_to_its_beat() {
    if (tripped() == Trip::none && clock_.now_s() - page_.rescuer_beat_s > options_.watchdog_s)
      let_go(Trip::watchdog_gone, "the rescuer shows no sign of life");
  }

  // What a program is told after a trip. That it may open the device again, it must not hear while a force may be on.
  [[nodiscard]] std::string let_go_text() const {
    const std::string why(to_string(tripped()));
    if (page_.device_zero) return "the guard let go: " + why + "; open the device again";
    return fmt::format(
        "FORCE MAY STILL BE ON: use the physical switch (the guard let go: {}; {} attempts to bring the "
        "device to zero so far, each may take {:.2f} s)",
        why, page_.attempts.load(), 2.0 * page_.open_took_s);
  }

  GuardReply answer(const GuardRequest& request) {
    GuardReply reply;
    if (tripped() != Trip::none) {
      reply.status = static_cast<int>(DeviceStatus::failed);
      reply.advised = 1;
      copy_message(reply.message, let_go_text());
      reply.confirmed = page_.device_zero ? 1 : 0;
      return reply;
    }
    if (request.ask == GuardAsk::zero) {
      reply.confirmed = zero_confirmed() ? 1 : 0;
      if (reply.confirmed != 0) return reply;
      let_go(Trip::zero_not_confirmed, "the device did not confirm zero");
      reply.confirmed = page_.device_zero ? 1 : 0;
      return reply;
    }
    return exchange(Vec3(request.f_N[0], request.f_N[1], request.f_N[2]));
  }

  GuardReply exchange(const Vec3& wanted) {
    const double now = clock_.now_s();
    ForceSupervisor::Input in;
    in.now_s = now;
    in.state = state_;
    in.wanted_W_N = wanted;
    in.calibrated = calibrated_;
    in.dead_man_held = true;  // the program's: a guard has no terminal
    // At zero there is nothing to limit: a person may move the handle at will. The supervisor begins anew with the
    // first force; after a pause the state is asked for first.
    const bool old_state = now - state_.t_s > options_.limits.stale_s;
    const bool at_rest = !pushing() && (wanted.isZero(0.0) || old_state);
    if (at_rest || (!pushing() && now - last_command_s_ > options_.limits.stale_s)) supervisor_.rest(now);
    last_command_s_ = now;
    Vec3 allowed = Vec3::Zero();
    if (calibrated_ && known_state_ && !at_rest) allowed = supervisor_.allow(in);
    if (!wanted.allFinite()) supervisor_.trip(Trip::not_finite);
    GuardReply reply;
    if (supervisor_.tripped() != Trip::none) {
      let_go(supervisor_.tripped(), "a limit does not hold");
      return answer({});
    }
    GuardRequest request;
    for (int k = 0; k < 3; ++k) request.f_N[k] = allowed[k];
    const bool on = !allowed.isZero(0.0);
    if (on && !pushing()) {
      hold_rescuer_to_its_beat();
      if (tripped() != Trip::none) return answer({});
      beat();
      page_.pushing = true;
      enter(GuardPhase::pushing, Trip::none, "a force is commanded");
    }
    const Received got = ask(request, reply, on || pushing() ? options_.driver_timeout_s : options_.idle_timeout_s);
    if (got != Received::message) {
      const bool gone = got == Received::gone;
      let_go(gone ? Trip::driver_gone : Trip::driver_silent,
             gone ? "the driver's process died" : "the driver did not answer in time");
      return answer({});
    }
    if (reply.status != 0) {
      if (pushing()) {
        let_go(Trip::device_error, reply.message);
      } else if (reply.confirmed == 0) {
        let_go(Trip::zero_not_confirmed, reply.message);
      }
      return reply;
    }
    take_state(reply);
    if (calibrated_) {
      if (const Trip trip = supervisor_.judge_state(state_, clock_.now_s()); trip != Trip::none && on) {
        let_go(trip, "the device's state is out of its limits");
        return answer({});
      }
    }
    if (!on && pushing()) {
      page_.pushing = false;
      enter(GuardPhase::at_zero, Trip::none, "zero is commanded");
    }
    for (int k = 0; k < 3; ++k) reply.allowed_N[k] = allowed[k];
    return reply;
  }

  void take_state(const GuardReply& reply) {
    state_.t_s = reply.t_s;
    state_.p_W_m = Vec3(reply.p_m[0], reply.p_m[1], reply.p_m[2]);
    state_.v_W_m_per_s = Vec3(reply.v_m_per_s[0], reply.v_m_per_s[1], reply.v_m_per_s[2]);
    state_.temperature_C = reply.temperature_C;
    calibrated_ = reply.calibrated != 0;
    known_state_ = true;
  }

  // Sends to the driver and waits for the reply to this request, beating meanwhile.
  Received ask(GuardRequest request, GuardReply& reply, double within_s) {
    request.number = ++number_;
    if (!send_message(driver_, request)) return Received::gone;
    const double deadline = clock_.now_s() + within_s;
    for (;;) {
      beat();
      const Received got = receive_message(driver_, reply, std::min(deadline, clock_.now_s() + beat_s));
      if (got == Received::gone || (got == Received::message && reply.number == request.number)) return got;
      if (got == Received::nothing && clock_.now_s() >= deadline) return got;
    }
  }

  bool zero_confirmed() {
    GuardRequest request;
    request.ask = GuardAsk::zero;
    for (int i = 0; i < most_zeros; ++i) {
      GuardReply reply;
      if (ask(request, reply, pushing() ? zero_answer_s : options_.idle_timeout_s) != Received::message) return false;
      if (reply.confirmed == 0) continue;
      page_.device_zero = true;
      supervisor_.rest(clock_.now_s());
      if (pushing()) {
        page_.pushing = false;
        if (tripped() == Trip::none) enter(GuardPhase::at_zero, Trip::none, "zero was asked for");
      }
      return true;
    }
    return false;
  }

  // To zero, confirmed, then the motors off; final.
  void let_go(Trip reason, const char* why) {
    if (tripped() != Trip::none) return;
    page_.tripped_s = clock_.now_s();
    page_.trip_for(reason);
    enter(GuardPhase::letting_go, reason, why);
    const bool driver_lives = reason != Trip::driver_gone && reason != Trip::driver_silent;
    if (driver_lives && zero_confirmed()) {
      page_.zeroed_s = clock_.now_s();
      GuardRequest off;
      off.ask = GuardAsk::motors_off;
      GuardReply reply;
      const bool confirmed = ask(off, reply, zero_answer_s) == Received::message && reply.confirmed != 0;
      page_.pushing = false;
      enter(GuardPhase::off, reason, confirmed ? "zero confirmed, motors off" : "zero confirmed");
      return;
    }
    enter(GuardPhase::rescue, reason, "the driver does not bring the device to zero");
    driver_process_.kill();
    rescue_.begin(reason);
    const char word = rescuer_rescue;
    ::send(rescuer_, &word, 1, MSG_DONTWAIT | MSG_NOSIGNAL);
    const double until = clock_.now_s() + rescue_answer_s;
    while (!rescue_.step() && clock_.now_s() < until) {
      beat();
      clock_.sleep_until(clock_.now_s() + rescue_step_s);
    }
  }

  void farewell() {
    if (pushing()) let_go(Trip::client_gone, "the program ended while a force was on");
    // The driver closes the device; the rescuer ends last, and only where the device is at zero.
    ::close(client_);
    GuardRequest end;
    end.ask = GuardAsk::end;
    send_message(driver_, end);
    GuardReply last;
    receive_message(driver_, last, clock_.now_s() + farewell_s);
    if (rescue_.begun()) {
      for (beat(); !rescue_.step(); beat()) clock_.sleep_until(clock_.now_s() + rescue_step_s);
    }
    const char word = rescuer_end;
    ::send(rescuer_, &word, 1, MSG_DONTWAIT | MSG_NOSIGNAL);
  }

  int client_, driver_, rescuer_;
  const GuardOptions& options_;
  GuardPage& page_;
  ForceSupervisor supervisor_;
  ProcessHandle driver_process_;
  Rescue rescue_;
  DeviceState state_;
  bool calibrated_, known_state_ = false;
  double last_command_s_ = -1e9;
  unsigned number_ = 0;
  MonotonicClock clock_;
};

// What the driver says of the device that it opened, or why it did not. Returns false if the program went away
// meanwhile: nothing is pushed yet, and the driver ends with its socket.
bool hear_of_opening(int client, int driver, const GuardOptions& options, GuardPage& page, GuardHello& hello) {
  const MonotonicClock clock;
  const double deadline = clock.now_s() + options.open_timeout_s;
  Received got = Received::nothing;
  while (got == Received::nothing && clock.now_s() < deadline) {
    page.guard_beat_s = clock.now_s();
    got = receive_message(driver, hello, clock.now_s() + beat_idle_s);
    pollfd there{client, 0, 0};
    if (::poll(&there, 1, 0) > 0) return false;
  }
  if (got != Received::message) {
    hello.status = static_cast<int>(got == Received::gone ? DeviceStatus::failed : DeviceStatus::timed_out);
    copy_message(hello.message, got == Received::gone ? "the driver's process died while it opened the device"
                                                      : "the driver did not open the device in time");
  }
  return true;
}

// One guard per device, whatever the hardware map calls it: by what the device says of itself. Held as long as a
// process of this guard lives that can command it.
std::unique_ptr<DeviceLock> lock_for(GuardHello& hello) {
  if (hello.status != 0) return nullptr;
  try {
    return std::make_unique<DeviceLock>(DeviceIdentity{hello.id, hello.serial, "", "", hello.emulated != 0},
                                        ::getppid());
  } catch (const DeviceError& error) {
    hello.status = static_cast<int>(error.device_status());
    hello.advised = 1;
    copy_message(hello.message, error.what());
    return nullptr;
  }
}

// Forks the rescuer, which inherits the device's lock, and waits until it watches: nothing is pushed without it.
bool start_rescuer(int client, int driver, const std::array<int, 2>& ends, const OpenDevice& open,
                   const GuardOptions& options, GuardPage& page) {
  const pid_t pid = ::fork();
  if (pid == 0) {
    for (const int fd : {client, driver, ends[0]}) ::close(fd);
    ::_exit(run_rescuer(ends[1], open, options, page));
  }
  ::close(ends[1]);
  if (pid < 0) return false;
  page.rescuer_pid = pid;
  MonotonicClock clock;
  for (const double until = clock.now_s() + options.open_timeout_s; page.rescuer_beat_s == 0.0;) {
    page.guard_beat_s = clock.now_s();
    if (clock.now_s() > until) return false;
    clock.sleep_until(clock.now_s() + rescue_step_s);
  }
  return true;
}

}  // namespace

int run_guard(int client, const OpenDevice& open, const GuardOptions& options, GuardPage& page) {
  let_write(page, true);
  const auto missing = harden(guard_priority, LockedMemory::also_future);
  if (!missing.empty())
    page.log(MonotonicClock().now_s(), GuardPhase::opening, Trip::none, ("guard without " + missing).c_str());
  page.guard_pid = ::getpid();
  std::signal(SIGCHLD, SIG_IGN);  // also the rescuer's (guard_processes.h)
  std::array<int, 2> driver{}, rescuer{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, driver.data()) != 0) return 1;
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, rescuer.data()) != 0) return 1;
  const pid_t driver_pid = ::fork();
  if (driver_pid == 0) {
    for (const int fd : {client, driver[0], rescuer[0], rescuer[1]}) ::close(fd);
    std::signal(SIGCHLD, SIG_DFL);  // as a vendor's library expects it
    ::_exit(run_driver(driver[1], open, options, page));
  }
  if (driver_pid < 0) return 1;
  page.driver_pid = driver_pid;
  ::close(driver[1]);
  const ProcessHandle driver_process(driver_pid);
  GuardHello hello;
  if (!hear_of_opening(client, driver[0], options, page, hello)) return 1;
  const auto lock = lock_for(hello);
  if (hello.status == 0 && !start_rescuer(client, driver[0], rescuer, open, options, page)) {
    hello.status = static_cast<int>(DeviceStatus::failed);
    copy_message(hello.message, "the second watchdog's process could not be started");
  }
  const bool open_for_use = send_message(client, hello) && hello.status == 0;
  if (open_for_use) Guard(client, driver[0], rescuer[0], open, options, page, hello.calibrated != 0).serve();
  ::close(driver[0]);
  ::close(rescuer[0]);
  // A driver that does not come back from closing is ended.
  if (!driver_process.ends_within(farewell_s) && page.device_zero) driver_process.kill();
  return open_for_use ? 0 : 1;
}

}  // namespace touchstone::hil
