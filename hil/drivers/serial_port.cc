#include "drivers/serial_port.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

namespace touchstone::hil {
namespace {

speed_t speed_of(const std::string& place, int baud) {
  constexpr std::pair<int, speed_t> speeds[] = {{9600, B9600},     {19200, B19200},   {38400, B38400},
                                                {57600, B57600},   {115200, B115200}, {230400, B230400},
                                                {460800, B460800}, {921600, B921600}, {1000000, B1000000}};
  for (const auto& [known, speed] : speeds) {
    if (known == baud) return speed;
  }
  throw DeviceError(DeviceStatus::failed, fmt::format("{}: {} baud is no usual speed of a serial line", place, baud),
                    "9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600 and 1000000 are");
}

// Unix98 pseudo-terminals (Documentation/admin-guide/devices.txt): their other end is a program.
constexpr unsigned pseudo_terminal_first = 136, pseudo_terminal_last = 143;

}  // namespace

SerialPort::SerialPort(const std::string& called, const std::string& node, int baud)
    : place_(fmt::format("{} at {}", called, node)) {
  const speed_t speed = speed_of(place_, baud);
  fd_ = ::open(node.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0) {
    const auto status = errno == EACCES  ? DeviceStatus::no_permission
                        : errno == EBUSY ? DeviceStatus::busy
                                         : DeviceStatus::absent;
    throw DeviceError(status, fmt::format("{}: {}", place_, std::strerror(errno)),
                      errno == EACCES ? "your user must be in the node's group (dialout)" : "");
  }
  const auto fail = [&](DeviceStatus status, const std::string& why, const std::string& advice = "") {
    ::close(std::exchange(fd_, -1));
    throw DeviceError(status, fmt::format("{}: {}", place_, why), advice);
  };
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) fail(DeviceStatus::busy, "another program has it");
  termios line{};
  if (::tcgetattr(fd_, &line) != 0) fail(DeviceStatus::failed, "is no serial line", "is it the right node?");
  ::cfmakeraw(&line);
  line.c_cflag |= CLOCAL | CREAD;
  line.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  ::cfsetispeed(&line, speed);
  ::cfsetospeed(&line, speed);
  if (::tcsetattr(fd_, TCSANOW, &line) != 0) fail(DeviceStatus::failed, std::strerror(errno));
  struct stat about {};
  emulated_ = ::fstat(fd_, &about) == 0 && major(about.st_rdev) >= pseudo_terminal_first &&
              major(about.st_rdev) <= pseudo_terminal_last;
}

SerialPort::~SerialPort() {
  if (fd_ >= 0) ::close(fd_);
}

void SerialPort::send_break() {
  ::tcflush(fd_, TCIOFLUSH);
  if (::tcsendbreak(fd_, 0) != 0)
    throw DeviceError(DeviceStatus::failed, fmt::format("{}: takes no break: {}", place_, std::strerror(errno)));
}

void SerialPort::flush() noexcept { ::tcflush(fd_, TCIFLUSH); }

void SerialPort::write(const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto n = ::write(fd_, bytes.data() + done, bytes.size() - done);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if (errno == EAGAIN) {
      pollfd ready{fd_, POLLOUT, 0};
      if (::poll(&ready, 1, 1000) <= 0)
        throw DeviceError(DeviceStatus::timed_out, fmt::format("{}: takes no bytes", place_));
    } else if (errno != EINTR) {
      throw DeviceError(DeviceStatus::gone, fmt::format("{}: {}", place_, std::strerror(errno)));
    }
  }
}

std::size_t SerialPort::read(std::span<unsigned char> out, double deadline_s, double& t_s) {
  MonotonicClock clock;
  for (;;) {
    const auto n = ::read(fd_, out.data(), out.size());
    t_s = clock.now_s();
    if (n > 0) return static_cast<std::size_t>(n);
    // A line that was unplugged reads as ended, or as an error of input.
    if (n == 0 || (errno != EAGAIN && errno != EINTR))
      throw DeviceError(DeviceStatus::gone, fmt::format("{}: the line is gone{}", place_,
                                                        n < 0 ? fmt::format(": {}", std::strerror(errno)) : ""));
    const double left = deadline_s - t_s;
    if (left <= 0.0) return 0;
    pollfd ready{fd_, POLLIN, 0};
    ::poll(&ready, 1, static_cast<int>(std::ceil(std::min(left, 3600.0) * 1e3)));
  }
}

}  // namespace touchstone::hil
