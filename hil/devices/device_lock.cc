#include "hil/devices/device_lock.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "hil/devices/device_error.h"
#include "hil/drivers/device_table.h"

namespace touchstone::hil {
namespace {

// Shared by all users of the machine, so that two of them cannot drive one device; sticky, so that none removes
// another's.
std::filesystem::path lock_folder() {
  if (const char* const folder = std::getenv("TOUCHSTONE_LOCK_DIR"); folder != nullptr && *folder != '\0')
    return folder;
  return "/tmp/touchstone-locks";
}

// To write, or else to read, which is enough to lock: a file that another user made, also an old one that only he may
// write. Existing files are opened without O_CREAT, which the kernel refuses for another's file in a sticky folder
// (fs.protected_regular).
int open_lock_file(const std::filesystem::path& path) {
  constexpr int common = O_CLOEXEC | O_NOFOLLOW;
  for (int attempt = 0; attempt < 2; ++attempt) {
    int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | common, 0666);
    if (fd >= 0) {
      ::fchmod(fd, 0666);  // whatever the umask took away
      return fd;
    }
    if (errno != EEXIST) return -1;
    fd = ::open(path.c_str(), O_RDWR | common);
    if (fd < 0 && errno == EACCES) fd = ::open(path.c_str(), O_RDONLY | common);
    if (fd >= 0 || errno != ENOENT) return fd;  // ENOENT: it went away in between
  }
  return -1;
}

// The address as numbers; the name itself where nobody knows it.
std::string numeric_address(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0 || found == nullptr) return host;
  char text[INET_ADDRSTRLEN] = {};
  const auto* const address = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  ::inet_ntop(AF_INET, &address->sin_addr, text, sizeof text);
  ::freeaddrinfo(found);
  return text;
}

}  // namespace

std::string lock_name(const MappedDevice& device) {
  const KnownDevice* const known = find_known_device(device.id);
  if (known != nullptr && known->bus == Bus::network && !device.address.empty())
    return fmt::format("{}-{}", numeric_address(device.address), device.port != 0 ? device.port : device.udp_port);
  return device.address.empty() ? device.serial : device.address;
}

DeviceLock::DeviceLock(const MappedDevice& device) : DeviceLock(device.id, lock_name(device)) {}

DeviceLock::DeviceLock(const std::string& device_id, const std::string& name) {
  std::string file = device_id + "-" + (name.empty() ? "any" : name);
  for (char& c : file) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
  }
  const auto folder = lock_folder();
  ::mkdir(folder.c_str(), 01777);
  ::chmod(folder.c_str(), 01777);
  path_ = folder / (file + ".lock");
  descriptor_ = open_lock_file(path_);
  if (descriptor_ < 0) {
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("{}: the lock file cannot be opened: {}", path_.string(), std::strerror(errno)),
                      "set TOUCHSTONE_LOCK_DIR to a folder you may write");
  }
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    char holder[32] = {};
    const auto n = ::pread(descriptor_, holder, sizeof holder - 1, 0);
    ::close(descriptor_);
    throw DeviceError(DeviceStatus::busy, fmt::format("{} {}: another run has it{}", device_id, name,
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
