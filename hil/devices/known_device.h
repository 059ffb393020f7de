// What a device says of itself: how it is called, what it measures, how it is found, and who opens it. One entry per
// device, in the driver's own file (`extern const KnownDevice netft_device`); hil/drivers/device_table.cc lists them.
// Everything that lists, finds, records or renders on devices goes by these entries and knows no device by name.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "devices/hardware_map.h"
#include "devices/interfaces.h"

namespace touchstone::hil {

enum class Bus : std::uint8_t { usb, network, comedi, serial, invisible };
enum class DeviceRole : std::uint8_t { wrench_source, haptic_device, voltage_source, tracker };
// `confirmed`: vendor's documents or several independent sources; `reported`: one public source; `conflicting`: public
// lists disagree, so the product string decides.
enum class Confidence : std::uint8_t { confirmed, reported, conflicting };

// A name under which a device stands on USB.
struct UsbName {
  std::uint16_t vendor = 0;            // 0: none
  std::uint16_t product = 0;           // 0: any product of the vendor whose string matches
  std::string_view product_pattern{};  // found in the product string, case ignored; empty: ids decide
};

// What looking at a device's address showed.
struct DeviceSeen {
  std::string serial;          // empty: it does not say
  std::string where;           // what answered, and where
  bool serial_by_map = false;  // must be the one in the hardware map, if that names one
};

inline constexpr double open_timeout_s = 5.0;  // for the answer of a sensor on the network

struct KnownDevice {
  std::string_view id{};  // as in the hardware map
  std::string_view name{};
  DeviceRole role = DeviceRole::wrench_source;  // what it measures, or does
  Bus bus = Bus::invisible;
  std::array<UsbName, 3> usb{};
  std::string_view source{};  // of its identification and of its protocol
  Confidence confidence = Confidence::reported;
  std::string_view note{};  // what a user must know, or why it cannot be seen
  // The form of the hardware map's "address", as an example; empty: it needs none.
  std::string_view address_example{};
  std::string_view calibrating{};  // what a person does with a handle that says it is not calibrated
  bool one_axis = false;           // a force sensor that measures along one axis only
  bool needs_calibration = false;  // a file, which the hardware map names
  // A list of all devices does not connect to it: it may serve one client, or keep one waiting.
  bool connected_when_named = false;
  int usual_port = 0;  // of its server, if the map's "port" names none; 0: the map's "udp_port" is its address

  // What it can be opened as; null: not that. All throw DeviceError where it cannot be opened, UsageError where the
  // hardware map lacks what it needs. The address is there if an example is,
  // and the calibration file if one is needed.
  std::unique_ptr<WrenchSource> (*open_force)(const MappedDevice& device, double card_rate_Hz) = nullptr;
  std::unique_ptr<PoseSource> (*open_poses)(const MappedDevice& device) = nullptr;
  std::unique_ptr<HapticDevice> (*open_handle)(const MappedDevice& device) = nullptr;
  // A device on the network: asks what is there within the time, changes and commands nothing. Throws as above.
  DeviceSeen (*look)(const MappedDevice& device, double timeout_s) = nullptr;
};

std::string_view to_string(Bus bus);
std::string_view to_string(Confidence confidence);

}  // namespace touchstone::hil
