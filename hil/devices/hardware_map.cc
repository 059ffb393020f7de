#include "devices/hardware_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "drivers/device_table.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/json_reader.h"
#include "lab/finding.h"

namespace touchstone::hil {
namespace {

int whole_from(JsonObject& object, std::string_view key, int otherwise, double least, double most,
               std::string_view expected) {
  const double value = object.optional_number(key).value_or(otherwise);
  if (!(value >= least && value <= most) || value != std::floor(value)) object.fail_at(key, expected);
  return static_cast<int>(value);
}

int port_of(JsonObject& object, std::string_view key, int otherwise) {
  return whole_from(object, key, otherwise, 1, 65535, "a port from 1 to 65535 was expected");
}

double not_negative(JsonObject& object, std::string_view key) {
  const double value = object.optional_number(key).value_or(0.0);
  if (!(value >= 0.0)) object.fail_at(key, "must not be negative");
  return value;
}

// Of trackers, load cells and serial lines.
void read_stream_settings(JsonObject& object, MappedDevice& device, const std::filesystem::path& folder) {
  device.baud = whole_from(object, "baud", 0, 0, 1e7, "a speed in baud, a whole number, was expected");
  device.rate_Hz = not_negative(object, "rate_Hz");
  device.body = object.optional_text("body").value_or("");
  if (const auto file = object.optional_text("tool_file")) device.tool_file = (folder / *file).string();
  device.newtons_per_unit = object.optional_number("newtons_per_unit").value_or(0.0);
  device.value = whole_from(object, "value", 1, 1, 100, "the place of a number in a line, from 1, was expected");
  const auto axis = object.optional_text("axis").value_or("z");
  if (axis != "x" && axis != "y" && axis != "z") object.fail_at("axis", "x, y or z was expected");
  device.axis = axis.front();
}

MappedDevice read_device(JsonObject& object, const std::filesystem::path& folder) {
  MappedDevice device;
  device.id = object.text("id");
  if (find_known_device(device.id) == nullptr) {
    object.fail_at("id", fmt::format("\"{}\" is not a device known here; known: {}", device.id,
                                     ids_of_devices([](const KnownDevice&) { return true; })));
  }
  device.serial = object.optional_text("serial").value_or("");
  device.connected = object.optional_flag("connected").value_or(false);
  device.fixture = object.optional_text("fixture").value_or("");
  device.force_limit_N = object.optional_number("force_limit_N").value_or(0.0);
  if (!(device.force_limit_N >= 0.0)) object.fail_at("force_limit_N", "must not be negative");
  device.address = object.optional_text("address").value_or("");
  device.http_port = port_of(object, "http_port", device.http_port);
  device.udp_port = port_of(object, "udp_port", device.udp_port);
  if (object.has("port")) device.port = port_of(object, "port", 0);
  read_stream_settings(object, device, folder);
  device.library = object.optional_text("library").value_or("");
  device.firmware = object.optional_text("firmware").value_or("");
  device.dead_man = object.optional_text("dead_man").value_or("");
  if (object.has("limits")) {
    auto limits = object.object("limits");
    for (const auto& name : limits.keys()) {
      device.limits[name] = limits.number(name);
      try {
        lab_limits({{name, device.limits[name]}});
      } catch (const UsageError& error) {
        limits.fail_at(name, error.what());
      }
    }
    limits.finish();
  }
  if (object.has("calibration")) {
    auto calibration = object.object("calibration");
    device.calibration_file = folder / calibration.text("file");
    device.calibration_sha256 = calibration.optional_text("sha256").value_or("");
    if (const auto day = calibration.optional_text("expires")) {
      device.calibration_expires =
          recording::parse_day(*day, calibration.source() + ": " + calibration.place() + "/expires");
    }
    calibration.finish();
  }
  object.finish();
  return device;
}

}  // namespace

const MappedDevice* HardwareMap::find(std::string_view id) const {
  const auto found = std::find_if(devices.begin(), devices.end(), [&](const MappedDevice& d) { return d.id == id; });
  return found == devices.end() ? nullptr : &*found;
}

HardwareMap load_hardware_map(const std::filesystem::path& path) {
  const auto json = load_json(path);
  HardwareMap map;
  map.source = path.string();
  JsonObject root(json, path.string(), "");
  root.schema("touchstone-hardware/1");
  for (auto& object : root.objects("devices")) map.devices.push_back(read_device(object, path.parent_path()));
  root.finish();
  return map;
}

HardwareMap hardware_map_from_environment() {
  const char* const path = std::getenv("TOUCHSTONE_HARDWARE_MAP");
  if (path == nullptr || *path == '\0') return {};
  return load_hardware_map(path);
}

CalibrationState calibration_state(const MappedDevice& device, const recording::CalendarDay& today) {
  std::error_code error;
  if (!device.calibration_file || !std::filesystem::exists(*device.calibration_file, error))
    return CalibrationState::absent;
  if (!device.calibration_sha256.empty() && sha256_file(*device.calibration_file) != device.calibration_sha256)
    return CalibrationState::changed;
  if (device.calibration_expires && *device.calibration_expires < today) return CalibrationState::expired;
  return CalibrationState::usable;
}

recording::CalendarDay today() {
  const std::chrono::year_month_day day{std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now())};
  return {static_cast<int>(day.year()), static_cast<int>(static_cast<unsigned>(day.month())),
          static_cast<int>(static_cast<unsigned>(day.day()))};
}

}  // namespace touchstone::hil
