// A socket of an emulator on a free port of 127.0.0.1.
#pragma once

#include <cstdint>

namespace touchstone::hil {

struct LoopbackSocket {
  int fd = -1;  // the caller closes it
  std::uint16_t port = 0;
};

// Throw std::runtime_error if the machine has no free port, saying why.
LoopbackSocket listen_on_loopback();     // TCP
LoopbackSocket datagrams_on_loopback();  // UDP

}  // namespace touchstone::hil
