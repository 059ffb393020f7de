// A serial line of 8 bits without parity, as bytes. Each read says when its bytes were there: the kernel stamps no
// serial bytes, so that a USB adapter's own delay (up to 16 ms for FTDI's at its usual setting) is in these times.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "devices/interfaces.h"

namespace touchstone::hil {

// On the line: 8 bits, a start and a stop bit.
constexpr double bits_per_byte = 10.0;

class SerialPort {
 public:
  // Throws DeviceError(absent | no_permission | busy | failed) naming the node; `called` is the device in messages.
  SerialPort(const std::string& called, const std::string& node, int baud);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  void write(const std::string& bytes);
  // What has come, at least a byte unless the deadline passes first: then 0. Throws DeviceError(gone).
  std::size_t read(std::span<unsigned char> out, double deadline_s, double& t_s);
  // Holds the line low for a quarter of a second or more, on which some devices reset. What has come is forgotten.
  void send_break();
  // Forgets what has come.
  void flush() noexcept;
  [[nodiscard]] const std::string& place() const noexcept { return place_; }
  // The line is a pseudo-terminal: a program, not a device.
  [[nodiscard]] bool emulated() const noexcept { return emulated_; }

 private:
  std::string place_;
  int fd_ = -1;
  bool emulated_ = false;
};

}  // namespace touchstone::hil
