#include "hil/devices/device_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "hil/devices/device_error.h"

namespace touchstone::hil {
namespace {

// Shared by all users of the machine, so that two of them cannot drive one device; sticky, so that none removes
// another's.
std::filesystem::path lock_folder() {
  if (const char* const folder = std::getenv("TOUCHSTONE_LOCK_DIR"); folder != nullptr && *folder != '\0')
    return folder;
  return "/tmp/touchstone-locks";
}

}  // namespace

DeviceLock::DeviceLock(const std::string& device_id, const std::string& serial) {
  std::string name = device_id + "-" + (serial.empty() ? "any" : serial);
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_') c = '_';
  }
  const auto folder = lock_folder();
  ::mkdir(folder.c_str(), 01777);
  ::chmod(folder.c_str(), 01777);
  path_ = folder / (name + ".lock");
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) {
    throw DeviceError(
        DeviceStatus::failed,
        fmt::format("{}: the lock file cannot be opened: {}; set TOUCHSTONE_LOCK_DIR to a folder you may write",
                    path_.string(), std::strerror(errno)));
  }
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    char holder[32] = {};
    const auto n = ::pread(descriptor_, holder, sizeof holder - 1, 0);
    ::close(descriptor_);
    throw DeviceError(DeviceStatus::busy, fmt::format("{} {}: another run has it{}", device_id, serial,
                                                      n > 0 ? fmt::format(" (process {})", holder) : ""));
  }
  const auto pid = std::to_string(::getpid());
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, pid.data(), pid.size(), 0) < 0) {
    // Only the message to a second run suffers.
  }
}

DeviceLock::~DeviceLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace touchstone::hil
