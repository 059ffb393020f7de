// An OnRobot HEX behind its Compute Box, on the loopback interface. It follows OnRobot's own example highspeed_udp.c
// (as published in jsbyysheng/onrobot_hex_ft_sensor): requests of 8 bytes, big-endian: 0x1234, command, data; records
// of 36 bytes; 10000 counts per N, 100000 per N m; period in ms by 0x82, filter by 0x81, bias by 0x42 (0 off, 0xff on),
// start with a count by 2, stop by 0. Not in that source and therefore not emulated: what the status bits mean, and
// whether count 0 streams for ever (that is OptoForce's ROS driver's use of it). All results say `emulated`.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

#include "devices/interfaces.h"

namespace touchstone::hil {

class OnRobotEmulator {
 public:
  // Force and torque [N, N m] over the emulator's own time since the stream began.
  explicit OnRobotEmulator(std::function<Wrench(double)> wrench);
  ~OnRobotEmulator();
  OnRobotEmulator(const OnRobotEmulator&) = delete;
  OnRobotEmulator& operator=(const OnRobotEmulator&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] int filter() const noexcept { return filter_; }
  // Commands that set the period, the filter or the bias.
  [[nodiscard]] int settings() const noexcept { return settings_; }
  [[nodiscard]] bool streams() const noexcept { return streams_; }

 private:
  void serve();

  std::function<Wrench(double)> wrench_;
  int socket_ = -1, port_ = 0;
  std::atomic<int> filter_{-1}, settings_{0};
  std::atomic<bool> streams_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace touchstone::hil
