// A TCP connection to a device or to its server, as bytes. Each read says when its bytes were there: the kernel stamps
// no stream, so that the delays of both networks are in these times.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "devices/interfaces.h"

namespace touchstone::hil {

class TcpLine {
 public:
  // Tries each address that the host has, within the time. Throws DeviceError(absent); `place` begins the messages.
  TcpLine(std::string place, const std::string& host, int port, double timeout_s);
  ~TcpLine();
  TcpLine(const TcpLine&) = delete;
  TcpLine& operator=(const TcpLine&) = delete;

  // Throws DeviceError(gone).
  void write(const std::string& bytes);
  // What has come, at least a byte unless the deadline passes first: then 0. Throws DeviceError(gone).
  std::size_t read(std::span<unsigned char> out, double deadline_s, double& t_s);
  [[nodiscard]] const std::string& place() const noexcept { return place_; }
  // The other side is on this machine: a program, not a device.
  [[nodiscard]] bool emulated() const noexcept { return emulated_; }

 private:
  std::string place_;
  int fd_ = -1;
  bool emulated_ = false;
};

}  // namespace touchstone::hil
