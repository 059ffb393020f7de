#include "safety/dead_man.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>

namespace touchstone::hil {
namespace {

// A descriptor that closes; -1 for none.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void close() noexcept {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  [[nodiscard]] int get() const noexcept { return fd_; }

 private:
  int fd_;
};

constexpr double repeat_stale_s = 0.15;

class TerminalDeadMan final : public DeadMan {
 public:
  explicit TerminalDeadMan(int fd, bool owned) : owned_(owned ? fd : -1), fd_(fd) {
    if (::tcgetattr(fd_, &before_) != 0)
      throw UsageError(
          "the dead-man input \"terminal\" needs a terminal; start from one, or use a pedal (input:/dev/input/eventN)");
    if (!foreground())
      throw UsageError("the dead-man input \"terminal\" needs this program in the foreground; start it without &");
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // signals stay: Ctrl-C still ends the run
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    ::tcsetattr(fd_, TCSAFLUSH, &raw);
  }
  ~TerminalDeadMan() override {
    if (foreground()) ::tcsetattr(fd_, TCSAFLUSH, &before_);
  }
  TerminalDeadMan(const TerminalDeadMan&) = delete;
  TerminalDeadMan& operator=(const TerminalDeadMan&) = delete;

  [[nodiscard]] std::string instruction() const override { return "hold the space bar"; }
  bool held(double now_s, const DeviceState&) noexcept override {
    // In the background a read would stop the program.
    if (!foreground()) {
      heartbeat_.release();
      return false;
    }
    std::array<char, 256> keys;
    bool beat = false;
    for (ssize_t n = 0; (n = ::read(fd_, keys.data(), keys.size())) > 0;) {
      for (ssize_t i = 0; i < n; ++i) {
        beat = keys[static_cast<std::size_t>(i)] == ' ';
        if (!beat) heartbeat_.release();
      }
    }
    // However many came: what piled up while nobody looked is one sign of life, not many.
    if (beat) heartbeat_.beat(now_s);
    return heartbeat_.held(now_s);
  }

 private:
  // A terminal that is not the controlling one (as of a test) has no foreground to be out of.
  [[nodiscard]] bool foreground() const noexcept {
    const pid_t group = ::tcgetpgrp(fd_);
    return group < 0 ? errno == ENOTTY : group == ::getpgrp();
  }

  Descriptor owned_;
  int fd_;
  termios before_{};
  Heartbeat heartbeat_{repeat_stale_s, 3};
};

class InputEventDeadMan final : public DeadMan {
 public:
  InputEventDeadMan(int fd, unsigned key) : fd_(fd), key_(key) { ::fcntl(fd, F_SETFL, O_NONBLOCK); }
  [[nodiscard]] std::string instruction() const override { return "hold the pedal (or key) down"; }
  bool held(double now_s, const DeviceState&) noexcept override {
    if (fd_.get() < 0) return false;
    bool beat = false;
    ssize_t n = 0;
    input_event event{};
    while ((n = ::read(fd_.get(), &event, sizeof event)) == static_cast<ssize_t>(sizeof event)) {
      if (event.type == EV_SYN && event.code == SYN_DROPPED) down_.reset(), beat = false;
      if (event.type != EV_KEY || (key_ != 0 && event.code != key_)) continue;
      if (event.value == 1 && !down_) down_ = event.code;
      if (down_ != event.code) continue;
      beat = event.value != 0;
      if (!beat) down_.reset();
    }
    if (n >= 0 || errno != EAGAIN) {  // its end, part of an event, or an error: the pedal is gone
      fd_.close();
      down_.reset();
    }
    if (!down_) heartbeat_.release();
    if (down_ && beat) heartbeat_.beat(now_s);
    const bool held = heartbeat_.held(now_s);
    // A key that fell silent must be pressed anew: its repeats alone do not bring it back.
    if (!held) down_.reset();
    return held;
  }

 private:
  Descriptor fd_;
  unsigned key_;
  std::optional<unsigned> down_;
  Heartbeat heartbeat_{repeat_stale_s, 1};
};

class PipeDeadMan final : public DeadMan {
 public:
  explicit PipeDeadMan(int fd) : fd_(fd) { ::fcntl(fd, F_SETFL, O_NONBLOCK); }
  [[nodiscard]] std::string instruction() const override { return "hold the switch behind the pipe"; }
  bool held(double now_s, const DeviceState&) noexcept override {
    std::array<char, 256> bytes;
    bool beat = false;
    ssize_t n = 0;
    while ((n = ::read(fd_.get(), bytes.data(), bytes.size())) > 0) {
      for (ssize_t i = 0; i < n; ++i) {
        const char c = bytes[static_cast<std::size_t>(i)];
        if (c == '\n' || c == ' ') continue;
        beat = c == '1';
        if (!beat) heartbeat_.release();
      }
    }
    if (n == 0 || errno != EAGAIN) {  // nobody holds the other end
      heartbeat_.release();
      return false;
    }
    if (beat) heartbeat_.beat(now_s);
    return heartbeat_.held(now_s);
  }

 private:
  Descriptor fd_;
  Heartbeat heartbeat_{0.1, 1};
};

class ButtonDeadMan final : public DeadMan {
 public:
  explicit ButtonDeadMan(std::uint32_t mask) : mask_(mask) {}
  [[nodiscard]] std::string instruction() const override { return "hold the button of the device"; }
  bool held(double now_s, const DeviceState& state) noexcept override {
    const double age = now_s - state.t_s;
    const bool fresh = age >= 0.0 && age <= 0.05, down = (state.buttons & mask_) == mask_;
    if (fresh && !down) seen_up_ = true;
    return seen_up_ && fresh && down;
  }

 private:
  std::uint32_t mask_;
  bool seen_up_ = false;
};

std::optional<unsigned> whole_number(std::string_view text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

int open_or_throw(const std::string& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd >= 0) return fd;
  const auto status = errno == EACCES                      ? DeviceStatus::no_permission
                      : errno == ENOENT || errno == ENODEV ? DeviceStatus::absent
                                                           : DeviceStatus::failed;
  throw DeviceError(
      status, fmt::format("dead-man input {}: {}", path, std::strerror(errno)),
      status == DeviceStatus::no_permission ? "the group \"input\" may read it, or a udev rule with uaccess" : "");
}

std::unique_ptr<DeadMan> open_input(const std::string& path, unsigned key) {
  const int fd = open_or_throw(path, O_RDONLY);
  // The first repeat after 100 ms, then every 30 ms: well within what counts as stale.
  std::array<unsigned, 2> repeat{100, 30};
  if (::ioctl(fd, EVIOCSREP, repeat.data()) != 0) {
    const int error = errno;
    ::close(fd);
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("dead-man input {}: its keys do not repeat ({}), so that a broken cable could not be "
                                  "told from a held pedal",
                                  path, std::strerror(error)),
                      "use one that acts as a keyboard");
  }
  ::ioctl(fd, EVIOCGRAB, 1);  // its keys are for us, not for the terminal; without the grab it works as well
  return std::make_unique<InputEventDeadMan>(fd, key);
}

}  // namespace

void Heartbeat::beat(double now_s) noexcept {
  if (beats_ > 0 && !(now_s >= last_s_ && now_s - last_s_ <= stale_s_)) beats_ = 0;
  if (!(now_s - now_s == 0.0)) {
    beats_ = 0;
    return;
  }
  if (beats_ < beats_before_) ++beats_;
  last_s_ = now_s;
}

bool Heartbeat::held(double now_s) noexcept {
  if (!(now_s >= last_s_ && now_s - last_s_ <= stale_s_)) beats_ = 0;
  return beats_ >= beats_before_;
}

std::unique_ptr<DeadMan> dead_man_from_terminal(int fd) { return std::make_unique<TerminalDeadMan>(fd, false); }
std::unique_ptr<DeadMan> dead_man_from_input_events(int fd, unsigned key) {
  return std::make_unique<InputEventDeadMan>(fd, key);
}
std::unique_ptr<DeadMan> dead_man_from_pipe(int fd) { return std::make_unique<PipeDeadMan>(fd); }
std::unique_ptr<DeadMan> dead_man_from_button(std::uint32_t mask) { return std::make_unique<ButtonDeadMan>(mask); }

std::unique_ptr<DeadMan> open_dead_man(const std::string& specification) {
  const auto colon = specification.find(':');
  const auto kind = specification.substr(0, colon);
  const auto rest = colon == std::string::npos ? std::string() : specification.substr(colon + 1);
  if (kind == "terminal" && colon == std::string::npos) {
    const int fd = ::open("/dev/tty", O_RDWR | O_CLOEXEC);
    if (fd < 0)
      throw UsageError(
          "the dead-man input \"terminal\" needs a terminal, and there is none; start from one, or use a pedal "
          "(input:/dev/input/eventN)");
    return std::make_unique<TerminalDeadMan>(fd, true);
  }
  if (kind == "button") {
    if (const auto bit = whole_number(rest); bit && *bit < 32) return dead_man_from_button(1U << *bit);
  }
  if (kind == "pipe" && !rest.empty()) return dead_man_from_pipe(open_or_throw(rest, O_RDONLY));
  if (kind == "input" && !rest.empty()) {
    const auto key_at = rest.rfind(':');
    if (key_at == std::string::npos) return open_input(rest, 0);
    if (const auto key = whole_number(rest.substr(key_at + 1)); key && *key > 0 && *key <= KEY_MAX)
      return open_input(rest.substr(0, key_at), *key);
  }
  throw UsageError(fmt::format(
      "dead-man input \"{}\": use terminal, input:/dev/input/eventN (or input:/dev/input/eventN:KEYCODE), button:N "
      "or pipe:PATH",
      specification));
}

}  // namespace touchstone::hil
