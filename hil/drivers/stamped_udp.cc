#include "drivers/stamped_udp.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>

namespace touchstone::hil {
namespace {

double seconds_of(const timespec& t) { return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec); }

constexpr std::uint32_t loopback_network = 127;

}  // namespace

void ask_for_stamps(int socket) noexcept {
  // A second of records at 7 kHz, should this process be scheduled away.
  const int buffer = 4 << 20, on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  ::setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
}

double real_now_s() noexcept {
  timespec real{};
  ::clock_gettime(CLOCK_REALTIME, &real);
  return seconds_of(real);
}

void StampedArrivals::received(double now_s, double real_now_s) noexcept {
  // The kernel slews a clock by up to 500 ppm (adjtimex); half a millisecond for the reading of two clocks one after
  // the other on a busy machine. A faster slew only costs the stamp.
  constexpr double slew = 500e-6, reading_s = 0.5e-3;
  const double difference_s = real_now_s - now_s;
  stepped_ = begun_ && std::abs(difference_s - difference_s_) > reading_s + slew * (now_s - now_s_);
  begun_ = true;
  difference_s_ = difference_s;
  now_s_ = now_s;
  real_s_ = real_now_s;
}

double StampedArrivals::arrival_s(double stamp_s) noexcept {
  constexpr double longest_wait_s = 10.0;  // many times what the socket's buffer holds
  constexpr double out_of_order_s = 1e-3;  // of the queues of one network card
  const double age_s = real_s_ - stamp_s;
  const double came_s = now_s_ - age_s;
  const bool sound = !stepped_ && age_s >= 0.0 && age_s < longest_wait_s && came_s > last_s_ - out_of_order_s;
  last_s_ = std::max(last_s_, sound ? came_s : now_s_);
  return sound ? came_s : now_s_;
}

double StampedArrivals::arrival_s(msghdr& header) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(&header); c != nullptr; c = CMSG_NXTHDR(&header, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
    return arrival_s(seconds_of(stamp));
  }
  return now_s_;
}

bool is_loopback(const sockaddr_storage& address) noexcept {
  if (address.ss_family == AF_INET6) {
    sockaddr_in6 v6{};
    std::memcpy(&v6, &address, sizeof v6);
    return IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr);
  }
  if (address.ss_family != AF_INET) return false;
  sockaddr_in v4{};
  std::memcpy(&v4, &address, sizeof v4);
  return ntohl(v4.sin_addr.s_addr) >> 24U == loopback_network;
}

long receive_stamped(int socket, StampedArrivals& arrivals, std::span<unsigned char> into, double& t_s,
                     sockaddr_storage* from) {
  iovec vector{into.data(), into.size()};
  StampBuffer stamp{};
  msghdr header{};
  header.msg_iov = &vector;
  header.msg_iovlen = 1;
  header.msg_control = stamp.bytes;
  header.msg_controllen = sizeof stamp.bytes;
  header.msg_name = from;
  header.msg_namelen = from != nullptr ? sizeof *from : 0;
  const auto n = ::recvmsg(socket, &header, MSG_DONTWAIT);
  if (n >= 0) {
    arrivals.received(MonotonicClock().now_s(), real_now_s());
    t_s = arrivals.arrival_s(header);
  }
  return n;
}

}  // namespace touchstone::hil
