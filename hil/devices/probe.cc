#include "hil/devices/probe.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

#include "hil/devices/device_table.h"
#include "hil/drivers/comedi_daq.h"
#include "hil/drivers/haply.h"
#include "hil/drivers/natnet.h"
#include "hil/drivers/ndi.h"
#include "hil/drivers/netft.h"
#include "hil/drivers/onrobot.h"
#include "hil/drivers/usb.h"
#include "hil/drivers/vrpn.h"

namespace touchstone::hil {
namespace {

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

void probe_tracker(ProbeResult& result, const MappedDevice& mapped, const ProbeOptions& options) {
  std::unique_ptr<PoseSource> source;
  if (result.id == "optitrack") {
    source = open_natnet({mapped.address, mapped.port != 0 ? mapped.port : natnet::command_port, mapped.body,
                          options.network_timeout_s, 0.0});
  } else {
    VrpnOptions vrpn = vrpn_options(mapped.address, mapped.body);
    if (mapped.port != 0) vrpn.port = mapped.port;
    vrpn.timeout_s = options.network_timeout_s;
    source = open_vrpn(vrpn);
  }
  result.status = DeviceStatus::present;
  result.serial = source->identity().serial;
  result.reason = fmt::format("{} at {}", source->identity().firmware, mapped.address);
}

// To say more than that it is there it would have to be reset, and with it the program that tracks with it.
void probe_ndi(ProbeResult& result, const MappedDevice& mapped, const ProbeOptions& options) {
  NdiOptions ndi;
  ndi.address = mapped.address;
  if (mapped.port != 0) ndi.port = mapped.port;
  ndi.timeout_s = options.network_timeout_s;
  reach_ndi(ndi);
  result.status = DeviceStatus::present;
  result.reason =
      fmt::format("{} takes the connection at port {}; its tools show when it is recorded", mapped.address, ndi.port);
}

// The service runs on this machine unless the map says where.
void probe_haply(ProbeResult& result, const MappedDevice* mapped, const ProbeOptions& options) {
  HaplyOptions haply;
  if (mapped != nullptr && !mapped->address.empty()) haply.host = mapped->address;
  if (mapped != nullptr && mapped->port != 0) haply.port = mapped->port;
  if (mapped != nullptr) haply.serial = mapped->serial;
  haply.timeout_s = options.network_timeout_s;
  const auto device = open_haply(haply);
  result.status = DeviceStatus::present;
  result.serial = device->identity().serial;
  result.reason = fmt::format("through Haply's service at {}{}", haply.host,
                              device->calibrated() ? "" : "; not calibrated yet: no force is commanded");
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

void probe_network(ProbeResult& result, const MappedDevice* mapped, const ProbeOptions& options) {
  const bool by_service = result.id == "haply-inverse3";
  if (!by_service && (mapped == nullptr || mapped->address.empty())) {
    result.reason = "a network sensor is looked for only where the hardware map gives its address";
    return;
  }
  try {
    if (by_service) {
      probe_haply(result, mapped, options);
      return;
    }
    if (result.id == "ndi-polaris") {
      if (mapped->address.front() == '/') {
        probe_serial(result, mapped);
      } else {
        probe_ndi(result, *mapped, options);
      }
      return;
    }
    if (const KnownDevice* const known = find_known_device(result.id); known->role == DeviceRole::tracker) {
      probe_tracker(result, *mapped, options);
      return;
    }
    if (result.id == "onrobot-hex") {
      const auto sensor = open_onrobot({mapped->address, mapped->udp_port}, options.network_timeout_s, false);
      result.status = DeviceStatus::present;
      result.reason = fmt::format("{} at {}", sensor->identity().firmware, mapped->address);
      return;
    }
    const auto configuration =
        read_netft_configuration({mapped->address, mapped->http_port, mapped->udp_port}, options.network_timeout_s);
    result.serial = configuration.serial;
    result.status = DeviceStatus::present;
    result.reason = fmt::format("{} at {}", configuration.product, mapped->address);
    if (!mapped->serial.empty() && mapped->serial != configuration.serial) {
      result.status = DeviceStatus::wrong_serial;
      result.reason += fmt::format(": serial {}, the hardware map wants {}", configuration.serial, mapped->serial);
    }
  } catch (const DeviceError& error) {
    result.status = error.device_status() == DeviceStatus::timed_out ? DeviceStatus::absent : error.device_status();
    result.reason = error.what();
  } catch (const BadData& error) {
    result.status = DeviceStatus::failed;
    result.reason = error.what();
  }
}

void probe_comedi(ProbeResult& result, const MappedDevice* mapped, const ProbeOptions& options) {
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
      if (result.id == "ati-nano17-daq" && (mapped == nullptr || !mapped->calibration_file)) {
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

ProbeResult probe_device(const KnownDevice& known, const HardwareMap& map, const ProbeOptions& options,
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
      probe_network(result, mapped, options);
      break;
    case Bus::serial:
      probe_serial(result, mapped);
      break;
    case Bus::comedi:
      probe_comedi(result, mapped, options);
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
  for (const KnownDevice& d : known_devices()) {
    if (d.bus == Bus::usb) vendors.push_back(d.vendor);
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
  for (const KnownDevice& known : known_devices()) {
    if (std::any_of(results.begin(), results.end(), [&](const ProbeResult& r) { return r.id == known.id; })) continue;
    results.push_back(probe_device(known, map, options, usb));
  }
  return results;
}

ProbeResult probe_one(const std::string& id, const HardwareMap& map, const ProbeOptions& options) {
  const KnownDevice* const known = find_known_device(id);
  if (known == nullptr)
    throw UsageError(fmt::format("{}: not a known device; touchstone hil probe without a name lists them", id));
  return probe_device(*known, map, options, known->bus == Bus::usb ? usb_devices() : std::vector<UsbDeviceInfo>{});
}

}  // namespace touchstone::hil
