#include "emulators/stepped_clock.h"

#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <ctime>

namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;
// As the machine's own clock has it: when it was stepped last, and by how much before and since.
std::atomic<std::int64_t> stepped_at_ns{0}, before_ns{0}, since_ns{0};

std::int64_t ns_of(const timespec& t) { return t.tv_sec * ns_per_s + t.tv_nsec; }

void step(timespec& t) {
  const std::int64_t true_ns = ns_of(t), ns = true_ns + (true_ns < stepped_at_ns ? before_ns : since_ns);
  t.tv_sec = ns / ns_per_s;
  t.tv_nsec = ns % ns_per_s;
}

void step_stamp(msghdr& header) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
    step(stamp);
    std::memcpy(CMSG_DATA(c), &stamp, sizeof stamp);
  }
}

}  // namespace

// In place of the C library's.
extern "C" {
int clock_gettime(clockid_t clock, timespec* t) noexcept {
  const auto result = static_cast<int>(::syscall(SYS_clock_gettime, clock, t));
  if (result == 0 && clock == CLOCK_REALTIME) step(*t);
  return result;
}

ssize_t recvmsg(int socket, msghdr* header, int flags) {
  const ssize_t n = ::syscall(SYS_recvmsg, socket, header, flags);
  if (n >= 0) step_stamp(*header);
  return n;
}

int recvmmsg(int socket, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  const auto n = static_cast<int>(::syscall(SYS_recvmmsg, socket, messages, count, flags, timeout));
  for (int i = 0; i < n; ++i) step_stamp(messages[i].msg_hdr);
  return n;
}
}

namespace touchstone::hil {

void step_system_clock(double by_s) {
  timespec now{};
  ::syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
  before_ns = since_ns.load();
  stepped_at_ns = ns_of(now);
  since_ns += static_cast<std::int64_t>(by_s * ns_per_s);
}

}  // namespace touchstone::hil
