// UDP packets with the time at which the kernel took each in (SO_TIMESTAMPNS), on the drivers' clock.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <span>
#include <string>

#include "harness/base/rooms.h"
#include "hil/devices/interfaces.h"

namespace touchstone::hil {

// Has the kernel stamp what comes, and keep 4 MB of it for a reader that is late.
void ask_for_stamps(int socket) noexcept;
// The kernel's stamp of a received packet on MonotonicClock's axis; `now_s` where there is none. Stamps are in
// CLOCK_REALTIME: where somebody set that clock in between, they make no sense and are not used.
double arrival_s(msghdr& header, double now_s, double real_now_s);
// CLOCK_REALTIME now.
double real_now_s() noexcept;
// True where the packet or its peer is on this machine's loopback interface.
bool is_loopback(const sockaddr_storage& address) noexcept;

// Control bytes for one packet's stamp.
struct alignas(cmsghdr) StampBuffer {
  char bytes[CMSG_SPACE(sizeof(timespec))];
};

// One packet that has come, without waiting: its length, or -1 with errno. `from` may be null.
long receive_stamped(int socket, std::span<unsigned char> into, double& t_s, sockaddr_storage* from);

}  // namespace touchstone::hil
