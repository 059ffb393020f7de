#include "drivers/open_mapped.h"

#include <fmt/format.h>

#include <string>

#include "drivers/device_table.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

const KnownDevice& entry_of(const MappedDevice& device) {
  const KnownDevice* const known = find_known_device(device.id);
  if (known == nullptr)
    throw UsageError(fmt::format("{}: not a known device; touchstone hil probe lists them", device.id));
  return *known;
}

// What its driver counts on.
void check_entry(const KnownDevice& known, const MappedDevice& device) {
  if (!known.address_example.empty() && device.address.empty())
    throw UsageError(
        fmt::format("{}: its \"address\" must be in the hardware map, as \"{}\"", known.id, known.address_example));
  if (known.needs_calibration && !device.calibration_file)
    throw UsageError(fmt::format("{}: its calibration file must be in the hardware map", known.id));
}

[[noreturn]] void none_of_that_kind(const MappedDevice& device, const char* what, const std::string& those) {
  throw UsageError(fmt::format("{}: no driver here {} it; these have one: {}", device.id, what, those));
}

}  // namespace

std::unique_ptr<WrenchSource> open_force(const MappedDevice& device, double card_rate_Hz) {
  const KnownDevice& known = entry_of(device);
  if (known.open_force == nullptr)
    none_of_that_kind(device, "reads forces from",
                      ids_of_devices([](const KnownDevice& d) { return d.open_force != nullptr; }));
  check_entry(known, device);
  auto source = known.open_force(device, card_rate_Hz);
  // Another sensor of its kind in its place has other errors, and perhaps another calibration.
  const std::string& serial = source->identity().serial;
  if (!device.serial.empty() && !serial.empty() && serial != device.serial)
    throw DeviceError(DeviceStatus::wrong_serial,
                      fmt::format("{}: serial {}, the hardware map wants {}", known.id, serial, device.serial));
  return source;
}

std::unique_ptr<PoseSource> open_poses(const MappedDevice& device) {
  const KnownDevice& known = entry_of(device);
  if (known.open_poses == nullptr)
    none_of_that_kind(device, "reads poses from",
                      ids_of_devices([](const KnownDevice& d) { return d.open_poses != nullptr; }));
  check_entry(known, device);
  return known.open_poses(device);
}

std::unique_ptr<HapticDevice> open_handle(const MappedDevice& device) {
  const KnownDevice& known = entry_of(device);
  if (known.open_handle == nullptr)
    none_of_that_kind(device, "renders forces on", ids_of_devices([](const KnownDevice& d) {
                                                     return d.open_handle != nullptr;
                                                   }) + "; any other device takes a plug-in (touchstone/device.h)");
  check_entry(known, device);
  return known.open_handle(device);
}

}  // namespace touchstone::hil
