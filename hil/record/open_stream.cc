#include "hil/record/open_stream.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "hil/devices/device_table.h"
#include "hil/drivers/bota.h"
#include "hil/drivers/comedi_daq.h"
#include "hil/drivers/load_cell.h"
#include "hil/drivers/natnet.h"
#include "hil/drivers/ndi.h"
#include "hil/drivers/netft.h"
#include "hil/drivers/onrobot.h"
#include "hil/drivers/open_mapped.h"
#include "hil/drivers/vrpn.h"

namespace touchstone::hil {
namespace {

const std::string& address_of(const MappedDevice& device, const char* example) {
  if (device.address.empty())
    throw UsageError(fmt::format("{}: its \"address\" must be in the hardware map, as \"{}\"", device.id, example));
  return device.address;
}

std::unique_ptr<WrenchSource> open_card(const MappedDevice& device, double rate_Hz) {
  if (!device.calibration_file) throw UsageError("ati-nano17-daq: its calibration file must be in the hardware map");
  ComediOptions options;
  if (!device.address.empty()) options.node = device.address;
  options.library = device.library;
  options.calibration_file = *device.calibration_file;
  options.sensor_serial = device.serial;
  options.rate_Hz = rate_Hz;
  return open_comedi_ati(options);
}

std::unique_ptr<WrenchSource> open_serial_force(const MappedDevice& device) {
  if (device.id == "bota-serial") {
    BotaOptions options;
    options.node = address_of(device, "/dev/ttyUSB0");
    if (device.baud != 0) options.baud = device.baud;
    return open_bota(options);
  }
  LoadCellOptions options;
  options.node = address_of(device, "/dev/ttyUSB0");
  if (device.baud != 0) options.baud = device.baud;
  options.newtons_per_unit = device.newtons_per_unit;
  options.value = device.value;
  options.axis = device.axis;
  options.rate_Hz = device.rate_Hz;
  return open_load_cell(options);
}

std::unique_ptr<PoseSource> open_tracker(const MappedDevice& device) {
  if (device.id == "optitrack") {
    NatNetOptions options;
    options.host = address_of(device, "192.168.1.10");
    if (device.port != 0) options.command_port = device.port;
    options.body = device.body;
    options.rate_Hz = device.rate_Hz;
    return open_natnet(options);
  }
  if (device.id == "vrpn") {
    VrpnOptions options = vrpn_options(address_of(device, "192.168.1.10"), device.body);
    if (device.port != 0) options.port = device.port;
    options.rate_Hz = device.rate_Hz;
    return open_vrpn(options);
  }
  if (device.id == "ndi-polaris") {
    NdiOptions options;
    options.address = address_of(device, "192.168.1.10 or /dev/ttyUSB0");
    if (device.port != 0) options.port = device.port;
    if (device.baud != 0) options.baud = device.baud;
    if (device.rate_Hz > 0.0) options.rate_Hz = device.rate_Hz;
    options.tool_file = device.tool_file;
    return open_ndi(options);
  }
  throw UsageError(fmt::format(
      "{}: no driver here reads poses from it; record a tracker that touchstone hil probe lists with a driver",
      device.id));
}

constexpr double open_timeout_s = 5.0;

}  // namespace

std::unique_ptr<WrenchSource> open_force(const MappedDevice& device, const StreamSettings& settings) {
  if (device.id == "ati-netft")
    return open_netft({address_of(device, "192.168.1.1"), device.http_port, device.udp_port}, open_timeout_s, false);
  if (device.id == "onrobot-hex")
    return open_onrobot({address_of(device, "192.168.1.1"), device.udp_port}, open_timeout_s, false);
  if (device.id == "ati-nano17-daq") return open_card(device, settings.card_rate_Hz);
  if (device.id == "bota-serial" || device.id == "hx711-serial") return open_serial_force(device);
  throw UsageError(fmt::format(
      "{}: no driver here reads forces from it; record a sensor that touchstone hil probe lists with a driver",
      device.id));
}

std::unique_ptr<Stream> open_stream(const MappedDevice& device, const StreamSettings& settings) {
  const KnownDevice* const known = find_known_device(device.id);
  if (known == nullptr)
    throw UsageError(fmt::format("{}: not a known device; touchstone hil probe lists them", device.id));
  switch (known->role) {
    case DeviceRole::wrench_source:
      return stream_of(open_force(device, settings), device.rate_Hz);
    case DeviceRole::tracker:
      return stream_of(open_tracker(device));
    case DeviceRole::haptic_device:
      return stream_of(open_mapped_device(device.id, device), settings.handle_rate_Hz);
    case DeviceRole::voltage_source:
      break;
  }
  throw UsageError(
      fmt::format("{}: cannot be recorded from; ati-nano17-daq records a sensor behind a card", device.id));
}

}  // namespace touchstone::hil
