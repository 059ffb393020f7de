#include "safety/guardian.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

#include "harness/base/error.h"
#include "safety/guard_messages.h"
#include "safety/guard_processes.h"
#include "safety/rescue.h"

namespace touchstone::hil {
namespace {

// The program's ends of all guards' sockets: a later guard must not hold an earlier one's open.
std::vector<int>& open_ends() {
  static std::vector<int> ends;
  return ends;
}

constexpr double longest_end_s = 2.0, usual_rescue_s = 0.05, answer_look_s = 0.005;

class Guarded final : public GuardedDevice {
 public:
  Guarded(int fd, pid_t guard, const GuardHello& hello, const GuardOptions& options, std::shared_ptr<GuardPage> page,
          OpenDevice open)
      : fd_(fd),
        guard_(guard),
        options_(options),
        page_(std::move(page)),
        watchdog_s_(hello.watchdog_s),
        calibrated_(hello.calibrated != 0),
        open_(std::move(open)) {
    identity_ = {hello.id, hello.serial, hello.firmware, hello.calibration, hello.emulated != 0};
    open_ends().push_back(fd_);
  }
  ~Guarded() override {
    std::erase(open_ends(), fd_);
    ::close(fd_);  // the guard sees it and lets go
    // It ends when the device is at rest. If it died, its rescuer may need a moment; a rescue that takes longer goes on
    // without this program.
    double deadline = clock_.now_s() + longest_end_s;
    while (::waitpid(guard_, nullptr, WNOHANG) == 0 && clock_.now_s() < deadline)
      clock_.sleep_until(clock_.now_s() + 0.001);
    deadline = std::min(deadline, clock_.now_s() + usual_rescue_s);
    while (!at_zero() && clock_.now_s() < deadline) clock_.sleep_until(clock_.now_s() + 0.001);
    if (!at_zero()) fmt::print(stderr, "{}\n", switch_text(*this));
  }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return watchdog_s_ > 0.0 ? watchdog_s_ : options_.limits.stale_s; }
  [[nodiscard]] bool calibrated() const override { return calibrated_; }
  [[nodiscard]] Trip tripped() const noexcept override { return page_->trip; }
  [[nodiscard]] GuardPhase phase() const noexcept override { return page_->phase; }
  [[nodiscard]] bool at_zero() const noexcept override { return page_->device_zero; }
  [[nodiscard]] double open_took_s() const noexcept override { return page_->open_took_s; }
  [[nodiscard]] Vec3 last_allowed_N() const noexcept override { return allowed_N_; }
  [[nodiscard]] std::vector<GuardEvent> events() const override { return page_->events(); }

  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    GuardRequest request;
    for (int k = 0; k < 3; ++k) request.f_N[k] = f_W_N[k];
    const GuardReply reply = ask(request, deadline_s);
    calibrated_ = reply.calibrated != 0;
    DeviceState state;
    state.t_s = reply.t_s;
    state.p_W_m = Vec3(reply.p_m[0], reply.p_m[1], reply.p_m[2]);
    state.v_W_m_per_s = Vec3(reply.v_m_per_s[0], reply.v_m_per_s[1], reply.v_m_per_s[2]);
    state.buttons = reply.buttons;
    state.temperature_C = reply.temperature_C;
    allowed_N_ = Vec3(reply.allowed_N[0], reply.allowed_N[1], reply.allowed_N[2]);
    return state;
  }

  bool zero_force() noexcept override {
    try {
      GuardRequest request;
      request.ask = GuardAsk::zero;
      return ask(request, clock_.now_s() + options_.idle_timeout_s).confirmed != 0;
    } catch (...) {
      return page_->device_zero;
    }
  }

 private:
  GuardReply ask(GuardRequest request, double deadline_s) {
    request.number = ++number_;
    const double asked_s = clock_.now_s();
    if (!send_message(fd_, request)) throw gone();
    GuardReply reply;
    do {
      switch (receive_message(fd_, reply, std::min(deadline_s, clock_.now_s() + answer_look_s))) {
        case Received::nothing:
          rescue_if_nobody_else();
          if (clock_.now_s() < deadline_s || its_turn_comes(asked_s)) continue;
          throw DeviceError(DeviceStatus::timed_out, fmt::format("{}: no answer before the deadline", identity_.id));
        case Received::gone:
          throw gone();
        case Received::message:
          break;
      }
    } while (reply.number != request.number);  // an answer that came after its deadline is not this one's
    if (reply.status != 0) throw problem_of(reply);
    return reply;
  }
  // Guard and rescuer are both stopped or dead, and the driver has not let go either by the time at which it would
  // have: this program is the last that can open the device.
  void rescue_if_nobody_else() {
    if (at_zero() || silent_s() <= patience_s()) return;
    let_write(*page_, true);
    for (const int pid : {page_->driver_pid.load(), page_->rescuer_pid.load(), page_->guard_pid.load()}) {
      if (pid > 0) ::kill(pid, SIGKILL);
    }
    Rescue rescue(Watchman::rescuer, open_, *page_, 0.0);
    rescue.begin(Trip::guard_gone);
    for (const double until = clock_.now_s() + longest_end_s; !rescue.step() && clock_.now_s() < until;)
      clock_.sleep_until(clock_.now_s() + 0.001);
    let_write(*page_, false);
  }
  // Neither has shown life since it was asked: whoever waits for an answer waits until it is to act, however short its
  // own deadline.
  [[nodiscard]] bool its_turn_comes(double asked_s) const {
    return !at_zero() && last_beat_s() < asked_s && silent_s() <= patience_s();
  }
  [[nodiscard]] double last_beat_s() const { return std::max(page_->guard_beat_s, page_->rescuer_beat_s); }
  [[nodiscard]] double silent_s() const { return clock_.now_s() - last_beat_s(); }
  [[nodiscard]] double patience_s() const { return options_.limits.stale_s + 2.0 * options_.watchdog_s; }
  [[nodiscard]] DeviceError gone() const {
    return {DeviceStatus::gone,
            fmt::format("{}: the guard process is gone ({})", identity_.id, to_string(page_->phase)),
            at_zero() ? "the device is at zero: open it again"
                      : "its rescuer brings the device to zero; FORCE MAY STILL BE ON until then: use the physical "
                        "switch if it is"};
  }

  int fd_;
  pid_t guard_;
  GuardOptions options_;
  std::shared_ptr<GuardPage> page_;
  DeviceIdentity identity_;
  double watchdog_s_;
  bool calibrated_;
  Vec3 allowed_N_ = Vec3::Zero();
  unsigned number_ = 0;
  OpenDevice open_;
  MonotonicClock clock_;
};

// A limit that is no number would let anything pass; a force or a patience without end would never end.
void check(const GuardOptions& options) {
  const auto& limits = options.limits;
  const std::pair<double, const char*> finite[] = {{limits.force_N, "force"},
                                                   {limits.stale_s, "age of a command"},
                                                   {options.driver_timeout_s, "driver time"},
                                                   {options.watchdog_s, "watchdog time"}};
  for (const auto& [value, name] : finite) {
    if (!std::isfinite(value) || value < 0.0)
      throw UsageError(
          fmt::format("the guard's limit of {} is {}: a finite number from 0 on was expected", name, value));
  }
  const std::pair<double, const char*> numbers[] = {{limits.slew_N_per_s, "force rate"},
                                                    {limits.speed_m_per_s, "speed"},
                                                    {limits.power_W, "power"},
                                                    {limits.energy_J, "energy"}};
  for (const auto& [value, name] : numbers) {
    if (!(value >= 0.0))
      throw UsageError(fmt::format("the guard's limit of {} is {}: a number from 0 on was expected", name, value));
  }
}

}  // namespace

std::string switch_text(const GuardedDevice& device) {
  return fmt::format("{} {}: FORCE MAY STILL BE ON (the guard let go: {}). USE THE PHYSICAL SWITCH.",
                     device.identity().id, device.identity().serial, to_string(device.tripped()));
}

bool wait_for_zero(const GuardedDevice& device, const std::function<bool()>& stop) {
  constexpr double again_s = 1.0;
  MonotonicClock clock;
  double says_at = clock.now_s() + usual_rescue_s;
  while (!device.at_zero()) {
    const double now = clock.now_s();
    if (now >= says_at) {
      if (stop()) return false;
      fmt::print(stderr, "\a{}\n", switch_text(device));
      says_at = now + again_s;
    }
    clock.sleep_until(now + answer_look_s);
  }
  return true;
}

std::unique_ptr<GuardedDevice> open_guarded(const OpenDevice& open, const GuardOptions& options) {
  check(options);
  auto page = options.page ? options.page : make_guard_page();
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw DeviceError(DeviceStatus::failed, fmt::format("socketpair: {}", std::strerror(errno)));
  const pid_t guard = ::fork();
  if (guard < 0) {
    const int error = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    throw DeviceError(DeviceStatus::failed, fmt::format("fork: {}", std::strerror(error)));
  }
  if (guard == 0) {
    ::close(ends[0]);
    for (const int end : open_ends()) ::close(end);
    ::setsid();  // out of the terminal's process group
    ::_exit(run_guard(ends[1], open, options, *page));
  }
  ::close(ends[1]);
  GuardHello hello;
  constexpr double margin_s = 2.0;  // the guard itself gives up earlier, and says why
  const Received heard = receive_message(ends[0], hello, MonotonicClock().now_s() + options.open_timeout_s + margin_s);
  if (heard != Received::message || hello.status != 0) {
    ::close(ends[0]);
    if (heard == Received::nothing) ::kill(guard, SIGKILL);
    ::waitpid(guard, nullptr, 0);
    if (heard == Received::message) throw problem_of(hello);
    throw DeviceError(DeviceStatus::failed, "the guard process did not open the device in time",
                      "is it switched on, and does no other program have it?");
  }
  let_write(*page, false);
  return std::make_unique<Guarded>(ends[0], guard, hello, options, std::move(page), open);
}

}  // namespace touchstone::hil
