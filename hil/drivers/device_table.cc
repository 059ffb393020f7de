#include "drivers/device_table.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "drivers/bota.h"
#include "drivers/comedi_daq.h"
#include "drivers/falcon.h"
#include "drivers/haply.h"
#include "drivers/leptrino.h"
#include "drivers/load_cell.h"
#include "drivers/natnet.h"
#include "drivers/ndi.h"
#include "drivers/netft.h"
#include "drivers/onrobot.h"
#include "drivers/qualisys.h"
#include "drivers/vendor_devices.h"
#include "drivers/vrpn.h"

namespace touchstone::hil {
namespace {

// Devices without a driver here.
constexpr KnownDevice ni_daq{.id = "ni-daq",
                             .name = "National Instruments data acquisition",
                             .role = DeviceRole::voltage_source,
                             .bus = Bus::usb,
                             .usb = {UsbName{0x3923, 0, "USB-6"}},
                             .source = "usb.ids and vendor forums disagree on products",
                             .confidence = Confidence::conflicting,
                             .note = "USB-621x needs the vendor's driver"};
constexpr KnownDevice comedi_daq{.id = "comedi-daq",
                                 .name = "Data acquisition card with a comedi driver",
                                 .role = DeviceRole::voltage_source,
                                 .bus = Bus::comedi,
                                 .source = "comedi.org (ni_pcimio and others)",
                                 .confidence = Confidence::confirmed,
                                 .note = "/dev/comedi0 to /dev/comedi15"};
constexpr KnownDevice phantom_omni{.id = "phantom-omni",
                                   .name = "SensAble PHANTOM Omni",
                                   .role = DeviceRole::haptic_device,
                                   .bus = Bus::invisible,
                                   .source = "vendor's manual",
                                   .confidence = Confidence::confirmed,
                                   .note = "is on FireWire, which libusb does not see"};
constexpr KnownDevice ni_pci_daq{.id = "ni-pci-daq",
                                 .name = "National Instruments PCI card without comedi",
                                 .role = DeviceRole::voltage_source,
                                 .bus = Bus::invisible,
                                 .source = "comedi.org",
                                 .confidence = Confidence::confirmed,
                                 .note = "a PCI card is only seen through its comedi node"};

// The one list.
constexpr std::array devices{
    &netft_device,
    &onrobot_device,
    &nano17_device,
    &bota_device,
    &leptrino_device,
    &load_cell_device,
    &natnet_device,
    &vrpn_device,
    &ndi_device,
    &qualisys_device,
    &falcon_device,
    &haply_device,
    &force_dimension_omega,
    &force_dimension_sigma,
    &force_dimension_delta,
    &openhaptics_device,
    &ni_daq,
    &comedi_daq,
    &phantom_omni,
    &ni_pci_daq,
};

bool contains_ignoring_case(std::string_view text, std::string_view pattern) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), pattern.begin(), pattern.end(), same) != text.end();
}

}  // namespace

std::span<const KnownDevice* const> known_devices() { return devices; }

const KnownDevice* find_known_device(std::string_view id) {
  const auto found = std::find_if(devices.begin(), devices.end(), [&](const KnownDevice* d) { return d->id == id; });
  return found == devices.end() ? nullptr : *found;
}

const KnownDevice* match_usb(std::uint16_t vendor, std::uint16_t product, std::string_view product_string) {
  // A pattern that matches beats an id: public lists give one id to several devices.
  const KnownDevice* by_id = nullptr;
  for (const KnownDevice* const d : devices) {
    for (const UsbName& name : d->usb) {
      if (name.vendor == 0 || name.vendor != vendor) continue;
      if (!name.product_pattern.empty() && contains_ignoring_case(product_string, name.product_pattern)) return d;
      if (name.product_pattern.empty() && name.product == product && by_id == nullptr) by_id = d;
    }
  }
  return by_id;
}

std::string calibrating_text(std::string_view id) {
  const KnownDevice* const device = find_known_device(id);
  return device == nullptr || device->calibrating.empty() ? "" : ": " + std::string(device->calibrating);
}

std::string ids_of_devices(bool (*holds)(const KnownDevice&)) {
  std::string ids;
  for (const KnownDevice* const d : devices) {
    if (holds(*d)) ids += (ids.empty() ? "" : ", ") + std::string(d->id);
  }
  return ids;
}

}  // namespace touchstone::hil
