#include "hil/safety/guardian.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "hil/safety/guard_messages.h"
#include "hil/safety/guard_processes.h"

namespace touchstone::hil {
namespace {

// The program's ends of all guards' sockets: a later guard must not hold an earlier one's open.
std::vector<int>& open_ends() {
  static std::vector<int> ends;
  return ends;
}

class Guarded final : public GuardedDevice {
 public:
  Guarded(int fd, pid_t guard, const GuardHello& hello, const GuardOptions& options, std::shared_ptr<GuardPage> page)
      : fd_(fd),
        guard_(guard),
        options_(options),
        page_(std::move(page)),
        watchdog_s_(hello.watchdog_s),
        calibrated_(hello.calibrated != 0) {
    identity_ = {hello.id, hello.serial, hello.firmware, hello.calibration, hello.emulated != 0};
    open_ends().push_back(fd_);
  }
  ~Guarded() override {
    std::erase(open_ends(), fd_);
    ::close(fd_);  // the guard sees it and lets go
    // It ends when the device is at rest; a rescue may take its time, and is not cut short.
    const double deadline = clock_.now_s() + 2.0;
    while (::waitpid(guard_, nullptr, WNOHANG) == 0 && clock_.now_s() < deadline)
      clock_.sleep_until(clock_.now_s() + 0.001);
  }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return watchdog_s_ > 0.0 ? watchdog_s_ : options_.limits.stale_s; }
  [[nodiscard]] bool calibrated() const override { return calibrated_; }
  [[nodiscard]] Trip tripped() const noexcept override { return page_->trip; }
  [[nodiscard]] GuardPhase phase() const noexcept override { return page_->phase; }
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
    if (!send_message(fd_, request)) throw gone();
    GuardReply reply;
    do {
      switch (receive_message(fd_, reply, deadline_s)) {
        case Received::nothing:
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
  [[nodiscard]] DeviceError gone() const {
    return {DeviceStatus::gone,
            fmt::format("{}: the guard process is gone ({})", identity_.id, to_string(page_->phase)),
            "its rescuer brings the device to zero: start again when it is at rest"};
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
  MonotonicClock clock_;
};

}  // namespace

std::unique_ptr<GuardedDevice> open_guarded(const OpenDevice& open, const GuardOptions& options) {
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
  return std::make_unique<Guarded>(ends[0], guard, hello, options, std::move(page));
}

}  // namespace touchstone::hil
