#include "emulators/loopback_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace touchstone::hil {
namespace {

LoopbackSocket bound_to_loopback(int type) {
  LoopbackSocket result;
  result.fd = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (result.fd < 0 || ::bind(result.fd, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      (type == SOCK_STREAM && ::listen(result.fd, 8) != 0) ||
      ::getsockname(result.fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    const std::system_error error(errno, std::generic_category(), "the emulator found no free port on 127.0.0.1");
    if (result.fd >= 0) ::close(result.fd);
    throw error;
  }
  result.port = ntohs(address.sin_port);
  return result;
}

}  // namespace

LoopbackSocket listen_on_loopback() { return bound_to_loopback(SOCK_STREAM); }

LoopbackSocket datagrams_on_loopback() { return bound_to_loopback(SOCK_DGRAM); }

}  // namespace touchstone::hil
