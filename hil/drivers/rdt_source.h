// The stream of records that ATI's Net F/T and others send over UDP (netft.h has its layout): packets stamped by the
// kernel, lost, late and repeated ones counted.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/netft.h"

namespace touchstone::hil {

struct RdtSensor {
  std::string called;  // in messages: "Net F/T"
  DeviceIdentity identity;
  double newtons_per_count = 0.0, newton_metres_per_count = 0.0;
  double rate_Hz = 0.0;  // 0: it does not say
  // Sent before the stream is asked for, with a pause after each.
  std::vector<std::pair<RdtCommand, std::uint32_t>> before_start;
  double between_commands_s = 0.005;
  std::uint32_t records = 0;  // that the stream has; 0: until it is stopped
};

// The socket is connected to the sensor, so that strangers' packets are not read. Throws DeviceError(absent).
std::unique_ptr<WrenchSource> open_rdt(const std::string& host, int udp_port, RdtSensor sensor);

}  // namespace touchstone::hil
