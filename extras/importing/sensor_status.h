// What the status words of network force-torque sensors say of a sample. Bits: Net F/T, ATI's manual 9620-05-Net FT,
// "System Status Code" (as public drivers list them); Ethernet Axia, ATI's manual 9610-05-Ethernet Axia-09, table 4.7.
// The two number their bits differently: the device must be known.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace touchstone::importing {

enum class StatusDevice { net_ft, ethernet_axia };

// "net-ft", "ethernet-axia"
std::optional<StatusDevice> find_status_device(std::string_view name);

struct SensorStatus {
  bool beyond_range = false;  // saturated: the force is larger than what was recorded
  bool faulty = false;        // any other error: the numbers may mean nothing
  std::string text;           // "transducer saturation or A/D error"; remarks that are no error too; empty: healthy
};

SensorStatus read_sensor_status(StatusDevice device, std::uint32_t word);

}  // namespace touchstone::importing
