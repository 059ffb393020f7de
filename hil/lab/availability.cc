#include "lab/availability.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

namespace touchstone::hil {
namespace {

bool flag(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace

Availability judge(const ProbeResult& result, bool require_all) {
  const auto reason = fmt::format("{} ({}): {}: {}", result.name, result.id, to_string(result.status), result.reason);
  if (result.status == DeviceStatus::present) return {Decision::run, false, reason};
  if (result.required) return {Decision::fail, false, reason + "; the hardware map calls it connected"};
  if (require_all) return {Decision::fail, false, reason + "; TOUCHSTONE_REQUIRE_HIL=1 allows no absence"};
  return {Decision::skip, false, reason};
}

Availability judge_dead_man(const Availability& device, const std::string& specification, bool must_run) {
  if (device.decision != Decision::run || device.emulated || !specification.empty()) return device;
  return {must_run ? Decision::fail : Decision::skip, false,
          device.reason +
              "; commands forces, and no dead-man input is set (TOUCHSTONE_HIL_DEAD_MAN, or \"dead_man\" in the "
              "hardware map)"};
}

Availability availability(const std::string& device_id) {
  const bool emulated = flag("TOUCHSTONE_HIL_EMULATED"), required = flag("TOUCHSTONE_REQUIRE_HIL");
  // An emulated run never counts as a hardware run, so the two demands contradict each other.
  if (emulated && required) {
    return {
        Decision::fail, true,
        "TOUCHSTONE_HIL_EMULATED=1 and TOUCHSTONE_REQUIRE_HIL=1 contradict each other: an emulator is not hardware"};
  }
  if (emulated) return {Decision::run, true, device_id + ": emulated"};
  return judge(probe_one(device_id, hardware_map_from_environment()), required);
}

}  // namespace touchstone::hil
