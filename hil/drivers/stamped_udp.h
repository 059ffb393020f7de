// UDP packets with the time at which the kernel took each in (SO_TIMESTAMPNS), on the drivers' clock.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <span>
#include <string>

#include "devices/interfaces.h"

namespace touchstone::hil {

// Has the kernel stamp what comes, and keep 4 MB of it for a reader that is late.
void ask_for_stamps(int socket) noexcept;
// The kernel's stamps of one socket's packets on MonotonicClock's axis. Stamps are in CLOCK_REALTIME, which anybody may
// set while packets wait: an age taken over such a step is wrong by it. So the difference of the two clocks is followed
// from one receipt to the next, and a batch across a change faster than a slew, and packets that would have come before
// those before them, get the time of their receipt: late, as arrivals may be, never early.
class StampedArrivals {
 public:
  // Once for each receipt of one or more packets, with both clocks just after it.
  void received(double now_s, double real_now_s) noexcept;
  // Of a packet of this receipt, in their order.
  double arrival_s(msghdr& header) noexcept;
  double arrival_s(double stamp_s) noexcept;

 private:
  double now_s_ = 0.0, real_s_ = 0.0, difference_s_ = 0.0, last_s_ = 0.0;
  bool begun_ = false, stepped_ = false;
};
// CLOCK_REALTIME now.
double real_now_s() noexcept;
// True where the packet or its peer is on this machine's loopback interface.
bool is_loopback(const sockaddr_storage& address) noexcept;

// Control bytes for one packet's stamp.
struct alignas(cmsghdr) StampBuffer {
  char bytes[CMSG_SPACE(sizeof(timespec))];
};

// One packet that has come, without waiting: its length, or -1 with errno. `from` may be null.
long receive_stamped(int socket, StampedArrivals& arrivals, std::span<unsigned char> into, double& t_s,
                     sockaddr_storage* from);

}  // namespace touchstone::hil
