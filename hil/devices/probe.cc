#include "devices/probe.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

#include "drivers/comedi_daq.h"
#include "drivers/device_table.h"
#include "drivers/usb.h"

namespace touchstone::hil {
namespace {

enum class Asked { for_all, by_name };

// A problem of the calibration, where the map names one.
std::optional<std::string> calibration_problem(const MappedDevice& device) {
  if (!device.calibration_file) return std::nullopt;
  switch (calibration_state(device, today())) {
    case CalibrationState::usable:
      return std::nullopt;
    case CalibrationState::absent:
      return fmt::format("its calibration file {} is missing", device.calibration_file->string());
    case CalibrationState::changed:
      return fmt::format("its calibration file {} is not the one in the hardware map (SHA-256 differs)",
                         device.calibration_file->string());
    case CalibrationState::expired:
      return fmt::format("its calibration expired on {}-{:02}-{:02}; have the sensor calibrated",
                         device.calibration_expires->year, device.calibration_expires->month,
                         device.calibration_expires->day);
  }
  return std::nullopt;
}

void probe_usb(ProbeResult& result, const MappedDevice* mapped, const std::vector<UsbDeviceInfo>& devices) {
  result.reason = "no such device on USB";
  for (const UsbDeviceInfo& device : devices) {
    const KnownDevice* const known = match_usb(device.vendor, device.product, device.product_name);
    if (known == nullptr || known->id != result.id) continue;
    result.serial = device.serial;
    result.status = device.status;
    const auto where = fmt::format("{:04x}:{:04x} \"{}\" on bus {} address {}", device.vendor, device.product,
                                   device.product_name, device.bus, device.address);
    if (device.status == DeviceStatus::no_permission) {
      result.reason =
          where + ": you may not open it; install hil/udev/70-touchstone-haptics.rules, then plug it in again";
    } else if (device.status == DeviceStatus::busy) {
      result.reason = where + ": another program has it";
    } else if (mapped != nullptr && !mapped->serial.empty() && mapped->serial != device.serial) {
      result.status = DeviceStatus::wrong_serial;
      result.reason = fmt::format("{}: serial {}, the hardware map wants {}", where, device.serial, mapped->serial);
      continue;  // another of its kind may be the right one
    } else {
      result.reason = fmt::format("{}; identified by {} ({})", where, known->source, to_string(known->confidence));
    }
    return;
  }
}

// A line says nothing of what is at its end: that it is there and may be opened is what can be known without starting
// the device.
void probe_serial(ProbeResult& result, const MappedDevice* mapped) {
  if (mapped == nullptr || mapped->address.empty()) {
    result.reason = "a serial device is looked for only where the hardware map gives its node";
    return;
  }
  if (::access(mapped->address.c_str(), R_OK | W_OK) == 0) {
    result.status = DeviceStatus::present;
    result.reason = fmt::format("the line {} is there; what is at its end shows when it is recorded", mapped->address);
    return;
  }
  result.status = errno == EACCES ? DeviceStatus::no_permission : DeviceStatus::absent;
  result.reason = fmt::format("{}: {}{}", mapped->address, std::strerror(errno),
                              errno == EACCES ? "; your user must be in the node's group (dialout)" : "");
}

void probe_network(ProbeResult& result, const KnownDevice& known, const MappedDevice* mapped, Asked asked,
                   const ProbeOptions& options) {
  if (!known.address_example.empty() && (mapped == nullptr || mapped->address.empty())) {
    result.reason = "a network device is looked for only where the hardware map gives its address";
    return;
  }
  const MappedDevice& device = mapped != nullptr ? *mapped : MappedDevice{};
  if (!device.address.empty() && device.address.front() == '/') {  // one that has a serial line, too
    probe_serial(result, mapped);
    return;
  }
  if (asked == Asked::for_all && known.connected_when_named) {
    result.status = DeviceStatus::not_asked;
    result.reason =
        fmt::format("at {} by the hardware map; touchstone hil probe {} connects to it", device.address, result.id);
    return;
  }
  try {
    const DeviceSeen seen = known.look(device, options.network_timeout_s);
    result.serial = seen.serial;
    result.status = DeviceStatus::present;
    result.reason = seen.where;
    if (seen.serial_by_map && !device.serial.empty() && device.serial != seen.serial) {
      result.status = DeviceStatus::wrong_serial;
      result.reason += fmt::format(": serial {}, the hardware map wants {}", seen.serial, device.serial);
    }
  } catch (const DeviceError& error) {
    result.status = error.device_status() == DeviceStatus::timed_out ? DeviceStatus::absent : error.device_status();
    result.reason = error.what();
  } catch (const Error& error) {  // what it said, or its entry in the map, is not as it must be
    result.status = DeviceStatus::failed;
    result.reason = error.what();
  }
}

void probe_comedi(ProbeResult& result, const KnownDevice& known, const MappedDevice* mapped,
                  const ProbeOptions& options) {
  std::vector<std::string> nodes;
  if (mapped != nullptr && !mapped->address.empty()) nodes.push_back(mapped->address);
  for (int i = 0; nodes.empty() && i < 16; ++i) {
    const auto node = fmt::format("/dev/comedi{}", i);
    std::error_code ignored;
    if (std::filesystem::exists(node, ignored)) nodes.push_back(node);
  }
  const auto& library = options.comedi_library.empty() && mapped != nullptr ? mapped->library : options.comedi_library;
  result.reason = "no /dev/comedi0 to /dev/comedi15: no card with a comedi driver";
  for (const auto& node : nodes) {
    try {
      const auto board = comedi_board(node, library);
      result.status = DeviceStatus::present;
      result.reason = fmt::format("{} at {}", board, node);
      if (known.needs_calibration && (mapped == nullptr || !mapped->calibration_file)) {
        result.status = DeviceStatus::calibration_expired;
        result.reason += ": the sensor behind it needs a calibration file in the hardware map";
      }
      return;
    } catch (const DeviceError& error) {
      result.status = error.device_status();
      result.reason = error.what();
    }
  }
}

ProbeResult probe_device(const KnownDevice& known, const HardwareMap& map, Asked asked, const ProbeOptions& options,
                         const std::vector<UsbDeviceInfo>& usb) {
  ProbeResult result;
  result.id = known.id;
  result.name = known.name;
  const MappedDevice* const mapped = map.find(result.id);
  result.required = mapped != nullptr && mapped->connected;
  switch (known.bus) {
    case Bus::usb:
      probe_usb(result, mapped, usb);
      break;
    case Bus::network:
      probe_network(result, known, mapped, asked, options);
      break;
    case Bus::serial:
      probe_serial(result, mapped);
      break;
    case Bus::comedi:
      probe_comedi(result, known, mapped, options);
      break;
    case Bus::invisible:
      result.status = DeviceStatus::invisible;
      result.reason = known.note;
      break;
  }
  if (mapped != nullptr && result.status == DeviceStatus::present) {
    if (const auto problem = calibration_problem(*mapped)) {
      result.status = DeviceStatus::calibration_expired;
      result.reason += ": " + *problem;
    }
  }
  return result;
}

std::vector<UsbDeviceInfo> usb_devices() {
  std::vector<std::uint16_t> vendors;
  for (const KnownDevice* const d : known_devices()) {
    for (const UsbName& name : d->usb) {
      if (name.vendor != 0) vendors.push_back(name.vendor);
    }
  }
  try {
    return UsbContext().devices(vendors);
  } catch (const DeviceError&) {
    return {};  // no USB at all: every USB device is absent
  }
}

}  // namespace

std::vector<ProbeResult> probe(const HardwareMap& map, const ProbeOptions& options) {
  const auto usb = usb_devices();
  std::vector<ProbeResult> results;
  for (const KnownDevice* const known : known_devices())
    results.push_back(probe_device(*known, map, Asked::for_all, options, usb));
  return results;
}

ProbeResult probe_one(const std::string& id, const HardwareMap& map, const ProbeOptions& options) {
  const KnownDevice* const known = find_known_device(id);
  if (known == nullptr)
    throw UsageError(fmt::format("{}: not a known device; touchstone hil probe without a name lists them", id));
  return probe_device(*known, map, Asked::by_name, options,
                      known->bus == Bus::usb ? usb_devices() : std::vector<UsbDeviceInfo>{});
}

}  // namespace touchstone::hil
