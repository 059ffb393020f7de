// What a laboratory has connected: devices with serial, calibration, fixture and force limit. A device that the map
// calls connected and that is absent is a failure, not a skip. JSON, schema "touchstone-hardware/1"; the environment
// variable TOUCHSTONE_HARDWARE_MAP names the file.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/recording/ati_calibration.h"

namespace touchstone::hil {

struct MappedDevice {
  std::string id;      // of the device table
  std::string serial;  // empty: any
  bool connected = false;
  std::optional<std::filesystem::path> calibration_file;
  std::string calibration_sha256;  // empty: not checked
  std::optional<recording::CalendarDay> calibration_expires;
  std::string fixture;         // what the device is mounted on, for the evidence
  double force_limit_N = 0.0;  // 0: nothing may be commanded
  std::string address;         // network: host of the sensor; comedi: /dev/comediN
  int http_port = 80;
  int udp_port = 49152;
  int port = 0;                          // of a tracker's or a service's server; 0: the usual one
  int baud = 0;                          // serial line; 0: the device's usual
  double rate_Hz = 0.0;                  // of a device that does not state its own; 0: unknown
  std::string body;                      // tracker: name (or number) of the rigid body; VRPN: name or name:sensor
  std::string tool_file;                 // NDI: the passive tool's definition (.rom)
  double newtons_per_unit = 0.0;         // load cell: of what its firmware prints
  int value = 1;                         // load cell: which number of a line is the load
  char axis = 'z';                       // load cell: along which it measures, in its own frame
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
CalibrationState calibration_state(const MappedDevice& device, const recording::CalendarDay& today);
recording::CalendarDay today();

}  // namespace touchstone::hil
