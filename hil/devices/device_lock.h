// One run per device, by an advisory lock: the kernel frees it when the holder dies, however it dies. Locks are shared
// by all users of the machine. A sensor on the network is locked by its address: two hardware maps that say more or
// less of it (a serial, a host name) still mean the same sensor.
#pragma once

#include <filesystem>
#include <string>

#include "harness/base/rooms.h"
#include "hil/devices/hardware_map.h"

namespace touchstone::hil {

class DeviceLock {
 public:
  // Throws DeviceError(busy) naming the process that holds it.
  DeviceLock(const std::string& device_id, const std::string& name);
  explicit DeviceLock(const MappedDevice& device);
  ~DeviceLock();
  DeviceLock(const DeviceLock&) = delete;
  DeviceLock& operator=(const DeviceLock&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

// What tells this device from others of its kind: the numeric address and port of a sensor on the network, the node of
// a card, the serial else.
std::string lock_name(const MappedDevice& device);

}  // namespace touchstone::hil
