#include "drivers/tcp_line.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <utility>

#include "drivers/stamped_udp.h"

namespace touchstone::hil {
namespace {

// Longer waits are several.
constexpr double longest_poll_s = 3600.0;

// False once the deadline has passed.
bool wait_for(int fd, short events, double deadline_s) {
  const double left_s = deadline_s - MonotonicClock().now_s();
  if (left_s <= 0.0) return false;
  pollfd ready{fd, events, 0};
  ::poll(&ready, 1, static_cast<int>(std::ceil(std::min(left_s, longest_poll_s) * 1e3)));
  return true;
}

// An error of connecting to this address by the deadline; 0: connected.
int connect_by(int fd, const addrinfo& address, double deadline_s) {
  if (::connect(fd, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd ready{fd, POLLOUT, 0};
  while (::poll(&ready, 1, 0) <= 0) {
    if (!wait_for(fd, POLLOUT, deadline_s)) return ETIMEDOUT;
  }
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace

TcpLine::TcpLine(std::string place, const std::string& host, int port, double timeout_s) : place_(std::move(place)) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0 || found == nullptr)
    throw DeviceError(DeviceStatus::absent, fmt::format("{}: the host is not known", place_));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, freeaddrinfo);
  const double until_s = MonotonicClock().now_s() + timeout_s;
  int error = 0;
  for (const addrinfo* address = found; address != nullptr && fd_ < 0; address = address->ai_next) {
    const int fd = ::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    error = fd < 0 ? errno : connect_by(fd, *address, until_s);
    if (error == 0)
      fd_ = fd;
    else if (fd >= 0)
      ::close(fd);
  }
  if (fd_ < 0)
    throw DeviceError(DeviceStatus::absent,
                      fmt::format("{}: {}", place_, error == ETIMEDOUT ? "no answer in time" : std::strerror(error)));
  const int on = 1;
  ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  sockaddr_storage peer{};
  socklen_t size = sizeof peer;
  emulated_ = ::getpeername(fd_, reinterpret_cast<sockaddr*>(&peer), &size) == 0 && is_loopback(peer);
}

TcpLine::~TcpLine() {
  if (fd_ >= 0) ::close(fd_);
}

void TcpLine::write(const std::string& bytes) {
  constexpr double patience_s = 1.0;
  const double until_s = MonotonicClock().now_s() + patience_s;
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto n = ::send(fd_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n > 0) {
      done += static_cast<std::size_t>(n);
    } else if ((errno != EAGAIN && errno != EINTR) || !wait_for(fd_, POLLOUT, until_s)) {
      throw DeviceError(DeviceStatus::gone, fmt::format("{}: takes no bytes: {}", place_, std::strerror(errno)));
    }
  }
}

std::size_t TcpLine::read(std::span<unsigned char> out, double deadline_s, double& t_s) {
  for (;;) {
    const auto n = ::recv(fd_, out.data(), out.size(), 0);
    if (n > 0) {
      t_s = MonotonicClock().now_s();
      return static_cast<std::size_t>(n);
    }
    if (n == 0 || (errno != EAGAIN && errno != EINTR))
      throw DeviceError(DeviceStatus::gone, fmt::format("{}: the other side closed the connection", place_));
    if (!wait_for(fd_, POLLIN, deadline_s)) return 0;
  }
}

}  // namespace touchstone::hil
