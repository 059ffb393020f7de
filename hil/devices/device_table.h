// The devices that a haptics laboratory may have, and how each is found: by USB vendor, product and product string, by
// network address, by a comedi node, or not by us at all, and then why. One line per device; `source` says where the
// identification comes from and `confidence` how far it can be trusted.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "harness/base/rooms.h"

namespace touchstone::hil {

enum class Bus : std::uint8_t { usb, network, comedi, serial, invisible };
enum class DeviceRole : std::uint8_t { wrench_source, haptic_device, voltage_source, tracker };
// `confirmed`: vendor's documents or several independent sources; `reported`: one public source; `conflicting`: public
// lists disagree, so the product string decides.
enum class Confidence : std::uint8_t { confirmed, reported, conflicting };

struct KnownDevice {
  std::string_view id;  // as in the hardware map
  std::string_view name;
  DeviceRole role;
  Bus bus;
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;              // 0: any product of the vendor whose string matches
  std::string_view product_pattern = {};  // found in the product string, case ignored; empty: ids decide
  std::string_view source = {};
  Confidence confidence = Confidence::reported;
  std::string_view note = {};  // what a user must know, or why it cannot be seen
};

std::span<const KnownDevice> known_devices();
const KnownDevice* find_known_device(std::string_view id);
// The devices that these USB ids and product string may be.
const KnownDevice* match_usb(std::uint16_t vendor, std::uint16_t product, std::string_view product_string);
std::string_view to_string(Bus bus);
std::string_view to_string(Confidence confidence);

}  // namespace touchstone::hil
