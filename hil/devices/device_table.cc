#include "hil/devices/device_table.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace touchstone::hil {
namespace {

constexpr auto wrench = DeviceRole::wrench_source;
constexpr auto haptic = DeviceRole::haptic_device;
constexpr auto volts = DeviceRole::voltage_source;
constexpr auto tracker = DeviceRole::tracker;

constexpr std::array devices{
    KnownDevice{"ati-netft", "ATI Net F/T", wrench, Bus::network, 0, 0, "",
                "ATI Net F/T manual: RDT on UDP 49152, HTTP configuration", Confidence::confirmed,
                "looked for at the addresses in the hardware map only"},
    KnownDevice{"onrobot-hex", "OnRobot HEX-E or HEX-H behind its Compute Box", wrench, Bus::network, 0, 0, "",
                "OnRobot's example highspeed_udp.c; OptoForce's ROS driver", Confidence::reported,
                "looked for at the addresses in the hardware map only; says no serial"},
    KnownDevice{"ati-nano17-daq", "ATI Nano17 through a data acquisition card", wrench, Bus::comedi, 0, 0, "",
                "ATI DAQ F/T manual: six gauge voltages and a calibration file", Confidence::confirmed,
                "the card is seen, the sensor behind it is not: its serial comes from the calibration file"},
    KnownDevice{"bota-serial", "Bota Systems force sensor with a serial line", wrench, Bus::serial, 0, 0, "",
                "Bota's Python interface and MATLAB example", Confidence::reported, "its node is in the hardware map"},
    KnownDevice{"hx711-serial", "Load cell behind an HX711 and a microcontroller that prints numbers", wrench,
                Bus::serial, 0, 0, "", "example sketches of the Arduino libraries HX711 and HX711_ADC",
                Confidence::reported, "one axis; says neither its unit nor its rate: the hardware map must"},
    KnownDevice{"optitrack", "OptiTrack cameras, by Motive's NatNet stream", tracker, Bus::network, 0, 0, "",
                "python_natnet and its captured packets; OptiTrack's SDK", Confidence::confirmed,
                "looked for at the address in the hardware map only"},
    KnownDevice{"vrpn", "A tracker behind a VRPN server (Vicon, Polhemus and others)", tracker, Bus::network, 0, 0, "",
                "VRPN's sources", Confidence::confirmed, "looked for at the address in the hardware map only"},
    KnownDevice{"ndi-polaris", "NDI Polaris or Aurora", tracker, Bus::network, 0, 0, "", "PlusToolkit's ndicapi",
                Confidence::reported, "serial node or network address in the hardware map"},
    KnownDevice{"novint-falcon", "Novint Falcon", haptic, Bus::usb, 0x0403, 0xcb48, "", "libnifalcon; linux-usb.org",
                Confidence::confirmed, "has no watchdog of its own: only run behind the guardian process"},
    KnownDevice{"haply-inverse3", "Haply Inverse3", haptic, Bus::network, 0, 0, "",
                "docs.haply.co: WebSocket protocol of the Inverse service", Confidence::confirmed,
                "through Haply's service, which must run; tried against an emulator only"},
    KnownDevice{"force-dimension-omega", "Force Dimension omega", haptic, Bus::usb, 0x1451, 0x0402, "",
                "usb.ids; vendor's udev rules", Confidence::reported,
                "through the vendor's library, tried against a stub only"},
    KnownDevice{"force-dimension-sigma", "Force Dimension sigma", haptic, Bus::usb, 0x1451, 0, "sigma",
                "public logs: also seen as 1451:0401", Confidence::conflicting,
                "through the vendor's library, tried against a stub only"},
    KnownDevice{"force-dimension-delta", "Force Dimension delta", haptic, Bus::usb, 0x1451, 0x0401, "",
                "usb.ids; vendor's udev rules", Confidence::reported,
                "through the vendor's library, tried against a stub only"},
    KnownDevice{"3ds-touch", "3D Systems Touch", haptic, Bus::usb, 0x2988, 0x0302, "", "public driver logs (cdc_acm)",
                Confidence::reported, "through the vendor's library, tried against a stub only"},
    KnownDevice{"3ds-touch", "3D Systems Touch", haptic, Bus::usb, 0x2988, 0x0304, "", "public driver logs (cdc_acm)",
                Confidence::reported, "through the vendor's library, tried against a stub only"},
    KnownDevice{"3ds-touch", "3D Systems Touch", haptic, Bus::usb, 0x8829, 0x0203, "",
                "one public source, its bytes swapped", Confidence::conflicting,
                "through the vendor's library, tried against a stub only"},
    KnownDevice{"ni-daq", "National Instruments data acquisition", volts, Bus::usb, 0x3923, 0, "USB-6",
                "usb.ids and vendor forums disagree on products", Confidence::conflicting,
                "USB-621x needs the vendor's driver"},
    KnownDevice{"comedi-daq", "Data acquisition card with a comedi driver", volts, Bus::comedi, 0, 0, "",
                "comedi.org (ni_pcimio and others)", Confidence::confirmed, "/dev/comedi0 to /dev/comedi15"},
    KnownDevice{"phantom-omni", "SensAble PHANTOM Omni", haptic, Bus::invisible, 0, 0, "", "vendor's manual",
                Confidence::confirmed, "is on FireWire, which libusb does not see"},
    KnownDevice{"ni-pci-daq", "National Instruments PCI card without comedi", volts, Bus::invisible, 0, 0, "",
                "comedi.org", Confidence::confirmed, "a PCI card is only seen through its comedi node"},
};

bool contains_ignoring_case(std::string_view text, std::string_view pattern) {
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), pattern.begin(), pattern.end(), same) != text.end();
}

}  // namespace

std::span<const KnownDevice> known_devices() { return devices; }

const KnownDevice* find_known_device(std::string_view id) {
  const auto found = std::find_if(devices.begin(), devices.end(), [&](const KnownDevice& d) { return d.id == id; });
  return found == devices.end() ? nullptr : &*found;
}

const KnownDevice* match_usb(std::uint16_t vendor, std::uint16_t product, std::string_view product_string) {
  // A pattern that matches beats an id: public lists give one id to several devices.
  const KnownDevice* by_id = nullptr;
  for (const KnownDevice& d : devices) {
    if (d.bus != Bus::usb || d.vendor != vendor) continue;
    if (!d.product_pattern.empty() && contains_ignoring_case(product_string, d.product_pattern)) return &d;
    if (d.product_pattern.empty() && d.product == product && by_id == nullptr) by_id = &d;
  }
  return by_id;
}

std::string_view to_string(Bus bus) {
  constexpr std::array names{"usb", "network", "comedi", "serial", "invisible"};
  return names[static_cast<std::size_t>(bus)];
}

std::string_view to_string(Confidence confidence) {
  constexpr std::array names{"confirmed", "reported", "conflicting"};
  return names[static_cast<std::size_t>(confidence)];
}

}  // namespace touchstone::hil
