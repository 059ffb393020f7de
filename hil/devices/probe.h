// Which of the known devices are here, and for each that cannot be used, why.
#pragma once

#include <string>
#include <vector>

#include "devices/device_error.h"
#include "devices/hardware_map.h"

namespace touchstone::hil {

struct ProbeResult {
  std::string id;  // of the device table
  std::string name;
  DeviceStatus status = DeviceStatus::absent;
  std::string serial;     // where it could be read
  std::string reason;     // one sentence: what was looked at, what was found, what to do
  bool required = false;  // the hardware map calls it connected
};

struct ProbeOptions {
  double network_timeout_s = 1.0;
  std::string comedi_library;  // for tests
};

// One result per known device, in the table's order. Opens devices to read their strings; commands nothing. One
// that serves one client (KnownDevice::connected_when_named) is left alone: not_asked.
std::vector<ProbeResult> probe(const HardwareMap& map, const ProbeOptions& options = {});
// The one device, connected to if need be; throws UsageError for an id that the table does not have.
ProbeResult probe_one(const std::string& id, const HardwareMap& map, const ProbeOptions& options = {});

}  // namespace touchstone::hil
