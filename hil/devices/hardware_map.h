// What a laboratory has connected: devices with serial, calibration, fixture and force limit. A device that the map
// calls connected and that is absent is a failure, not a skip. JSON, schema "touchstone-hardware/1"; the environment
// variable TOUCHSTONE_HARDWARE_MAP names the file.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/recording/ati_calibration.h"

namespace touchstone::hil {

struct MappedDevice {
  std::string id;      // of the device table
  std::string serial;  // empty: any
  bool connected = false;
  std::optional<std::filesystem::path> calibration_file;
  std::string calibration_sha256;  // empty: not checked
  std::optional<CalendarDay> calibration_expires;
  std::string fixture;         // what the device is mounted on, for the evidence
  double force_limit_N = 0.0;  // 0: nothing may be commanded
  std::string address;         // network: host of the sensor; comedi: /dev/comediN
  int http_port = 80;
  int udp_port = 49152;
  std::string library;                   // vendor's library, where it is not on the loader's path
  std::string firmware;                  // Falcon: the vendor's firmware file
  std::string dead_man;                  // what must be held while a test commands forces, as open_dead_man() takes it
  std::map<std::string, double> limits;  // of the lab's tests for this device, by LabLimits' names
};

struct HardwareMap {
  std::string source;
  std::vector<MappedDevice> devices;

  [[nodiscard]] const MappedDevice* find(std::string_view id) const;
};

// Throws BadData naming file, place and what was expected.
HardwareMap load_hardware_map(const std::filesystem::path& path);
// The map that the environment names; empty without one.
HardwareMap hardware_map_from_environment();

// What is wrong with a device's calibration on that day: nothing, or why it must not be used.
enum class CalibrationState { usable, absent, expired, changed };
CalibrationState calibration_state(const MappedDevice& device, const CalendarDay& today);
CalendarDay today();

}  // namespace touchstone::hil
