// OnRobot HEX-E and HEX-H (before: OptoForce) behind their Compute Box: records over UDP as those of a Net F/T
// (netft.h), but fixed counts, commands for rate and filter, and no configuration over HTTP.
//   Source: OnRobot's example highspeed_udp.c and OptoForce's ROS driver etherdaq_driver.cpp, as published in
// jsbyysheng/onrobot_hex_ft_sensor: port 49152; 10000 counts per N and 100000 per N m ("default divide value"); command
// 0x82 sets the period in ms, 0x81 the filter (0 none, 1 500 Hz, 2 150 Hz, 3 50 Hz, 4 15 Hz, 5 5 Hz, 6 1.5 Hz), 0x42
// the bias (0 off, 0xff on); 5 ms after each command. The sensor says neither serial nor scale: a box whose divide
// values were changed gives wrong newtons, which a known weight shows.
#pragma once

#include <memory>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

struct OnRobotOptions {
  std::string host;
  int udp_port = 49152;
  int period_ms = 2;  // from 1
  int filter = 0;     // 0 to 6, as above
};

// Throws UsageError for options out of range, DeviceError(absent) if no record comes within the time.
std::unique_ptr<WrenchSource> open_onrobot(const OnRobotOptions& options, double timeout_s, bool emulated);

extern const KnownDevice onrobot_device;

}  // namespace touchstone::hil
