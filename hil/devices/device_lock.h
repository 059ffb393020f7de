// One run per device: an advisory lock named after the device's id and serial. The kernel frees it when the holder
// dies, however it dies.
#pragma once

#include <filesystem>
#include <string>

namespace touchstone::hil {

class DeviceLock {
 public:
  // Throws DeviceError(busy) naming the process that holds it.
  DeviceLock(const std::string& device_id, const std::string& serial);
  ~DeviceLock();
  DeviceLock(const DeviceLock&) = delete;
  DeviceLock& operator=(const DeviceLock&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

}  // namespace touchstone::hil
