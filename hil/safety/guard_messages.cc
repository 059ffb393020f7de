#include "safety/guard_messages.h"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cmath>
#include <ctime>

namespace touchstone::hil {

void copy_message(char (&to)[longest_message], std::string_view from) {
  if (from.size() < longest_message) return copy_text(to, from);
  constexpr std::string_view gap = " [...] ";
  constexpr std::size_t kept = (longest_message - 1 - gap.size()) / 2;
  char* at = std::copy_n(from.data(), kept, to);
  at = std::copy_n(gap.data(), gap.size(), at);
  at = std::copy_n(from.data() + from.size() - kept, kept, at);
  *at = '\0';
}

bool send_bytes(int fd, const void* bytes, std::size_t size) {
  return ::send(fd, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(size);
}

Received receive_bytes(int fd, void* bytes, std::size_t size, double deadline_s) {
  const MonotonicClock clock;
  for (;;) {
    const double left = std::clamp(deadline_s - clock.now_s(), 0.0, 3600.0);
    const timespec wait{static_cast<time_t>(left), static_cast<long>((left - std::floor(left)) * 1e9)};
    pollfd ready{fd, POLLIN, 0};
    const int n = ::ppoll(&ready, 1, &wait, nullptr);
    if (n == 0) return Received::nothing;
    if (n < 0 && errno == EINTR) continue;
    const auto got = ::recv(fd, bytes, size, MSG_DONTWAIT);
    if (got == static_cast<ssize_t>(size)) return Received::message;
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    return Received::gone;  // its end, or something that is no message of ours
  }
}

}  // namespace touchstone::hil
