// One run per device, by an advisory lock: the kernel frees it when the last process that inherited it ends, however it
// ends. Locks are shared by all users of the machine.
//   A haptic device is locked by what it says of itself after it was opened, so that no wording of a hardware map and
//   no
// plug-in gets around it. A sensor on the network is locked by its address, before it is asked for anything.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "devices/hardware_map.h"
#include "devices/interfaces.h"

namespace touchstone::hil {

class DeviceLock {
 public:
  // Each throws DeviceError: busy, naming the process that holds it; failed if no lock can be had.
  explicit DeviceLock(const MappedDevice& sensor);
  // `holder` is the process that a second run is told of; 0: this one.
  explicit DeviceLock(const DeviceIdentity& opened, pid_t holder = 0);
  ~DeviceLock();
  DeviceLock(const DeviceLock&) = delete;
  DeviceLock& operator=(const DeviceLock&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  DeviceLock(const std::string& device, const std::string& name, pid_t holder);

  std::filesystem::path path_;
  int descriptor_ = -1;
};

// The names of their locks. Of a sensor the numeric address and port on the network, the node of a card, the serial
// else. Of an opened device its kind and serial; ids that stand for one kind of hardware (Force Dimension's) are one.
std::string lock_name(const MappedDevice& sensor);
std::string lock_name(const DeviceIdentity& opened);

}  // namespace touchstone::hil
