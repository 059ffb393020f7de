// A WebSocket client (RFC 6455, Boost.Beast) whose calls keep their deadlines. After a call that did not, or an error,
// the connection is of no more use: an answer that comes late would look like the next one's.
#pragma once

#include <memory>
#include <string>

#include "devices/interfaces.h"

namespace touchstone::hil {

class WebSocket {
 public:
  // Throws DeviceError(absent | timed_out); `called` is the peer in messages.
  WebSocket(const std::string& called, const std::string& host, int port, double timeout_s);
  ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  // Throw DeviceError(timed_out | gone).
  void send(const std::string& text, double deadline_s);
  // The next message, whole.
  const std::string& receive(double deadline_s);
  [[nodiscard]] bool good() const noexcept;
  // The peer is on this machine.
  [[nodiscard]] bool local() const noexcept;

 private:
  class Link;
  std::unique_ptr<Link> link_;
};

}  // namespace touchstone::hil
