#include <poll.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>

#include "hil/safety/guard_messages.h"
#include "hil/safety/guard_processes.h"
#include "hil/safety/harden.h"

namespace touchstone::hil {
namespace {

constexpr int guard_priority = 81;
constexpr double beat_s = 0.002;  // at least so often while a force is on: a quarter of watchdog_s
constexpr double beat_idle_s = 0.02;
constexpr double zero_answer_s = 0.003;   // a living driver answers a zero within this
constexpr int most_zeros = 5;             // that the device may refuse before it is opened anew
constexpr double rescue_answer_s = 0.05;  // then the guard serves the program again; the rescuer goes on
constexpr double farewell_s = 1.0;

class Guard {
 public:
  Guard(int client, int driver, int rescuer, const GuardOptions& options, GuardPage& page)
      : client_(client), driver_(driver), rescuer_(rescuer), options_(options), page_(page), supervisor_(limits()) {}

  int serve() {
    if (!greet()) return 1;
    for (;;) {
      beat();
      const double now = clock_.now_s();
      double wait = pushing() ? std::min(beat_s, last_command_s_ + options_.limits.stale_s - now) : beat_idle_s;
      wait = std::max(0.0, wait);
      const timespec time{0, static_cast<long>(wait * 1e9)};
      pollfd ready[2] = {{client_, POLLIN, 0}, {tripped() == Trip::none ? rescuer_ : -1, 0, 0}};
      ::ppoll(ready, 2, &time, nullptr);
      if ((ready[1].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) let_go(Trip::watchdog_gone, "the rescuer is gone");
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
    return 0;
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

  bool greet() {
    GuardHello hello;
    const double deadline = clock_.now_s() + options_.open_timeout_s;
    // The program may go meanwhile: nothing is pushed yet, and the driver ends with its socket.
    Received got = Received::nothing;
    while (got == Received::nothing && clock_.now_s() < deadline) {
      beat();
      got = receive_message(driver_, hello, clock_.now_s() + beat_idle_s);
      pollfd there{client_, 0, 0};
      if (::poll(&there, 1, 0) > 0) return false;
    }
    if (got != Received::message) {
      hello.status = static_cast<int>(got == Received::gone ? DeviceStatus::failed : DeviceStatus::timed_out);
      copy_message(hello.message, got == Received::gone ? "the driver's process died while it opened the device"
                                                        : "the driver did not open the device in time");
    }
    calibrated_ = hello.calibrated != 0;
    if (!send_message(client_, hello) || hello.status != 0) return false;
    enter(GuardPhase::at_zero, Trip::none, "the device is open");
    return true;
  }

  GuardReply answer(const GuardRequest& request) {
    GuardReply reply;
    if (tripped() != Trip::none) {
      reply.status = static_cast<int>(DeviceStatus::failed);
      reply.advised = 1;
      copy_message(reply.message, "the guard let go: " + std::string(to_string(tripped())) + "; open the device again");
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
    if (at_rest || (!pushing() && now - last_command_s_ > options_.limits.stale_s))
      supervisor_ = ForceSupervisor(limits());
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
    page_.tripped_s = clock_.now_s();
    page_.trip = reason;
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
    const char word = rescuer_rescue;
    [[maybe_unused]] const auto written = ::write(rescuer_, &word, 1);
    const double until = clock_.now_s() + rescue_answer_s;
    while (!page_.rescued && clock_.now_s() < until) {
      beat();
      clock_.sleep_until(clock_.now_s() + 0.0005);
    }
    if (page_.rescued) page_.pushing = false;
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
    while (!page_.device_zero && page_.phase == GuardPhase::rescue) {
      pollfd there{rescuer_, 0, 0};
      if (::poll(&there, 1, 0) > 0) break;  // nobody is left who could
      beat();
      clock_.sleep_until(clock_.now_s() + beat_s);
    }
    const char word = rescuer_end;
    [[maybe_unused]] const auto written = ::write(rescuer_, &word, 1);
  }

  int client_, driver_, rescuer_;
  const GuardOptions& options_;
  GuardPage& page_;
  ForceSupervisor supervisor_;
  DeviceState state_;
  bool calibrated_ = false, known_state_ = false;
  double last_command_s_ = -1e9;
  unsigned number_ = 0;
  MonotonicClock clock_;
};

}  // namespace

int run_guard(int client, const OpenDevice& open, const GuardOptions& options, GuardPage& page) {
  const auto missing = harden(guard_priority, LockedMemory::also_future);
  if (!missing.empty())
    page.log(MonotonicClock().now_s(), GuardPhase::opening, Trip::none, ("guard without " + missing).c_str());
  page.guard_pid = ::getpid();
  int driver[2], rescuer[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, driver) != 0) return 1;
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, rescuer) != 0) return 1;
  const pid_t driver_pid = ::fork();
  if (driver_pid == 0) {
    for (const int fd : {client, driver[0], rescuer[0], rescuer[1]}) ::close(fd);
    ::_exit(run_driver(driver[1], open, options, page));
  }
  if (driver_pid < 0) return 1;
  page.driver_pid = driver_pid;
  const pid_t rescuer_pid = ::fork();
  if (rescuer_pid == 0) {
    for (const int fd : {client, driver[0], driver[1], rescuer[0]}) ::close(fd);
    ::_exit(run_rescuer(rescuer[1], open, options, page));
  }
  if (rescuer_pid < 0) {
    ::kill(driver_pid, SIGKILL);
    return 1;
  }
  page.rescuer_pid = rescuer_pid;
  ::close(driver[1]);
  ::close(rescuer[1]);
  const int status = Guard(client, driver[0], rescuer[0], options, page).serve();
  ::close(driver[0]);
  ::close(rescuer[0]);
  const MonotonicClock clock;
  const double until = clock.now_s() + farewell_s;
  bool ended = false;
  while (!(ended = ::waitpid(driver_pid, nullptr, WNOHANG) != 0) && clock.now_s() < until)
    MonotonicClock().sleep_until(clock.now_s() + 0.001);
  if (!ended && page.device_zero) ::kill(driver_pid, SIGKILL);  // a driver that does not come back from closing
  return status;
}

}  // namespace touchstone::hil
