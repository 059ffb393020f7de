#include "hil/safety/guardian.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

namespace touchstone::hil {
namespace {

// Messages are plain structs over a local SEQPACKET socket between two processes of one program.
struct Hello {
  int status = 0;  // DeviceStatus
  int calibrated = 0;
  int emulated = 0;
  double watchdog_s = 0.0;
  char message[256] = {};
  char id[64] = {}, serial[64] = {}, firmware[96] = {}, calibration[160] = {};
};
struct Request {
  double f_N[3] = {};
  int zero_only = 0;
};
struct Reply {
  int status = 0;
  int calibrated = 0;
  double t_s = 0.0, p_m[3] = {}, v_m_per_s[3] = {};
  unsigned buttons = 0;
  char message[256] = {};
};

template <std::size_t n>
void copy_text(char (&to)[n], std::string_view from) {
  const std::size_t size = std::min(n - 1, from.size());
  std::copy_n(from.data(), size, to);
  to[size] = '\0';
}

bool wait_readable(int fd, double timeout_s) {
  pollfd ready{fd, POLLIN, 0};
  int n = 0;
  do {
    n = ::poll(&ready, 1, static_cast<int>(std::ceil(std::max(0.0, timeout_s) * 1e3)));
  } while (n < 0 && errno == EINTR);
  return n > 0;
}

template <class T>
bool send_all(int fd, const T& message) {
  return ::send(fd, &message, sizeof message, MSG_NOSIGNAL) == static_cast<ssize_t>(sizeof message);
}
template <class T>
bool receive_all(int fd, T& message, int flags = 0) {
  return ::recv(fd, &message, sizeof message, flags) == static_cast<ssize_t>(sizeof message);
}

using Open = std::function<std::unique_ptr<HapticDevice>()>;

Hello try_open(const Open& open, std::unique_ptr<HapticDevice>& device) {
  Hello hello;
  try {
    device = open();
    copy_text(hello.id, device->identity().id);
    copy_text(hello.serial, device->identity().serial);
    copy_text(hello.firmware, device->identity().firmware);
    copy_text(hello.calibration, device->identity().calibration);
    hello.emulated = device->identity().emulated;
    hello.calibrated = device->calibrated();
    hello.watchdog_s = device->watchdog_s();
  } catch (const DeviceError& error) {
    hello.status = static_cast<int>(error.device_status());
    copy_text(hello.message, error.what());
  } catch (const std::exception& error) {
    hello.status = static_cast<int>(DeviceStatus::failed);
    copy_text(hello.message, error.what());
  }
  return hello;
}

// The guardian's life. Returns its exit status.
int guard(int fd, const Open& open, const GuardianOptions& options) {
  // A terminal's Ctrl-C reaches the whole group: the guardian outlives it to bring the device down.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) std::signal(signal, SIG_IGN);
  std::unique_ptr<HapticDevice> device;
  const Hello hello = try_open(open, device);
  if (!send_all(fd, hello) || !device) {
    if (device) device->zero_force();
    return 1;
  }
  MonotonicClock clock;
  bool pushing = false;
  for (;;) {
    if (!wait_readable(fd, pushing ? options.heartbeat_s : 1.0)) {
      if (pushing) device->zero_force();  // the program hangs
      pushing = false;
      continue;
    }
    Request request;
    if (!receive_all(fd, request)) break;  // the program is gone
    Reply reply;
    try {
      if (request.zero_only != 0) {
        if (!device->zero_force()) reply.status = static_cast<int>(DeviceStatus::failed);
        pushing = false;
      } else {
        const Vec3 force(request.f_N[0], request.f_N[1], request.f_N[2]);
        pushing = force.squaredNorm() > 0.0;
        const DeviceState state = device->exchange(force, clock.now_s() + options.exchange_timeout_s);
        reply.t_s = state.t_s;
        for (int k = 0; k < 3; ++k) reply.p_m[k] = state.p_W_m[k], reply.v_m_per_s[k] = state.v_W_m_per_s[k];
        reply.buttons = state.buttons;
      }
      reply.calibrated = device->calibrated();
    } catch (const DeviceError& error) {
      device->zero_force();
      pushing = false;
      reply.status = static_cast<int>(error.device_status());
      copy_text(reply.message, error.what());
    }
    if (!send_all(fd, reply)) break;
  }
  // Once may fail on a busy bus: insist for a moment.
  for (int attempt = 0; attempt < 20 && !device->zero_force(); ++attempt) clock.sleep_until(clock.now_s() + 0.005);
  return 0;
}

class GuardedDevice final : public HapticDevice {
 public:
  GuardedDevice(int fd, pid_t guardian, const Hello& hello, const GuardianOptions& options)
      : fd_(fd),
        guardian_(guardian),
        options_(options),
        watchdog_s_(hello.watchdog_s),
        calibrated_(hello.calibrated != 0) {
    identity_ = {hello.id, hello.serial, hello.firmware, hello.calibration, hello.emulated != 0};
  }
  ~GuardedDevice() override {
    ::close(fd_);  // the guardian sees it and lets go
    const double deadline = clock_.now_s() + 2.0;
    while (::waitpid(guardian_, nullptr, WNOHANG) == 0) {
      if (clock_.now_s() > deadline) {
        ::kill(guardian_, SIGKILL);
        ::waitpid(guardian_, nullptr, 0);
        break;
      }
      clock_.sleep_until(clock_.now_s() + 0.001);
    }
  }
  GuardedDevice(const GuardedDevice&) = delete;
  GuardedDevice& operator=(const GuardedDevice&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return watchdog_s_ > 0.0 ? watchdog_s_ : options_.heartbeat_s; }
  [[nodiscard]] bool calibrated() const override { return calibrated_; }

  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    Request request;
    for (int k = 0; k < 3; ++k) request.f_N[k] = f_W_N[k];
    const Reply reply = ask(request, deadline_s);
    DeviceState state;
    state.t_s = reply.t_s;
    state.p_W_m = Vec3(reply.p_m[0], reply.p_m[1], reply.p_m[2]);
    state.v_W_m_per_s = Vec3(reply.v_m_per_s[0], reply.v_m_per_s[1], reply.v_m_per_s[2]);
    state.buttons = reply.buttons;
    return state;
  }

  bool zero_force() noexcept override {
    try {
      Request request;
      request.zero_only = 1;
      ask(request, clock_.now_s() + options_.exchange_timeout_s);
      return true;
    } catch (...) {
      return false;
    }
  }

 private:
  Reply ask(const Request& request, double deadline_s) {
    // An answer that came after its deadline must not be taken for this one's.
    Reply reply;
    while (owed_ > 0 && receive_all(fd_, reply, MSG_DONTWAIT)) --owed_;
    if (!send_all(fd_, request)) throw DeviceError(DeviceStatus::gone, "the guardian process is gone");
    ++owed_;
    while (owed_ > 0) {
      if (!wait_readable(fd_, deadline_s - clock_.now_s()))
        throw DeviceError(DeviceStatus::timed_out, fmt::format("{}: no answer before the deadline", identity_.id));
      if (!receive_all(fd_, reply)) throw DeviceError(DeviceStatus::gone, "the guardian process is gone");
      --owed_;
    }
    calibrated_ = reply.calibrated != 0;
    if (reply.status != 0) throw DeviceError(static_cast<DeviceStatus>(reply.status), reply.message);
    return reply;
  }

  int fd_;
  pid_t guardian_;
  GuardianOptions options_;
  DeviceIdentity identity_;
  double watchdog_s_;
  bool calibrated_;
  int owed_ = 0;
  MonotonicClock clock_;
};

}  // namespace

std::unique_ptr<HapticDevice> open_guarded(const Open& open, const GuardianOptions& options) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw DeviceError(DeviceStatus::failed, fmt::format("socketpair: {}", std::strerror(errno)));
  const pid_t guardian = ::fork();
  if (guardian < 0) throw DeviceError(DeviceStatus::failed, fmt::format("fork: {}", std::strerror(errno)));
  if (guardian == 0) {
    ::close(ends[0]);
    ::setsid();  // out of the terminal's process group
    ::_exit(guard(ends[1], open, options));
  }
  ::close(ends[1]);
  Hello hello;
  const bool heard = wait_readable(ends[0], 30.0) && receive_all(ends[0], hello);
  if (!heard || hello.status != 0) {
    ::close(ends[0]);
    if (!heard) ::kill(guardian, SIGKILL);
    ::waitpid(guardian, nullptr, 0);
    throw DeviceError(heard ? static_cast<DeviceStatus>(hello.status) : DeviceStatus::timed_out,
                      heard ? hello.message : "the guardian process did not open the device within 30 s");
  }
  return std::make_unique<GuardedDevice>(ends[0], guardian, hello, options);
}

}  // namespace touchstone::hil
