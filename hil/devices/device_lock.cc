#include "devices/device_lock.h"

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
#include <string_view>

#include "devices/device_error.h"
#include "drivers/device_table.h"

namespace touchstone::hil {
namespace {

constexpr const char* usual_folder = "/tmp/touchstone-locks";

DeviceError unusable(const std::filesystem::path& folder, const std::string& why) {
  return {DeviceStatus::failed, fmt::format("{}: device locks cannot be kept there: {}", folder.string(), why),
          "set TOUCHSTONE_LOCK_DIR to a folder of your own; it must be the same for all who use the device"};
}

// The usual folder is shared by all users of the machine, so that two of them cannot drive one device; sticky, so that
// none removes another's. What is there already stays as it is: a link, which anybody may lay, is not followed, and a
// folder that the user names keeps its mode. Returns a descriptor of it.
int open_lock_folder(std::filesystem::path& folder) {
  const char* const named = std::getenv("TOUCHSTONE_LOCK_DIR");
  const bool usual = named == nullptr || *named == '\0';
  folder = usual ? usual_folder : named;
  const bool made = ::mkdir(folder.c_str(), 0777) == 0;
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | (usual ? O_NOFOLLOW : 0));
  if (fd < 0) throw unusable(folder, errno == ELOOP || errno == ENOTDIR ? "it is no folder" : std::strerror(errno));
  struct stat there {};
  ::fstat(fd, &there);
  const bool mine = there.st_uid == ::geteuid() || there.st_uid == 0;
  if (made && usual && mine) ::fchmod(fd, 01777);
  constexpr mode_t shared = S_IWOTH | S_ISVTX;
  if (!made && usual && !mine && (there.st_mode & shared) != shared) {
    ::close(fd);
    throw unusable(folder, fmt::format("it belongs to user {}, who does not share it", there.st_uid));
  }
  return fd;
}

// To write, or else to read, which is enough to lock: a file that another user made, also an old one that only he may
// write. Existing files are opened without O_CREAT, which the kernel refuses for another's file in a sticky folder
// (fs.protected_regular). A second name of some other file, which anybody may have laid where fs.protected_hardlinks is
// off, is none of ours: it would be overwritten.
int open_lock_file(int folder, const std::string& name) {
  constexpr int common = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  for (int attempt = 0; attempt < 2; ++attempt) {
    int fd = ::openat(folder, name.c_str(), O_RDWR | O_CREAT | O_EXCL | common, 0666);
    if (fd >= 0) {
      ::fchmod(fd, 0666);  // whatever the umask took away
      return fd;
    }
    if (errno != EEXIST) return -1;
    fd = ::openat(folder, name.c_str(), O_RDWR | common);
    if (fd < 0 && errno == EACCES) fd = ::openat(folder, name.c_str(), O_RDONLY | common);
    struct stat there {};
    if (fd >= 0 && (::fstat(fd, &there) != 0 || !S_ISREG(there.st_mode) || there.st_nlink > 1)) {
      ::close(fd);
      errno = EEXIST;
      return -1;
    }
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
  if (known != nullptr && known->bus == Bus::network && !device.address.empty()) {
    const int usual = known->usual_port != 0 ? known->usual_port : device.udp_port;
    return fmt::format("{}-{}", numeric_address(device.address), device.port != 0 ? device.port : usual);
  }
  return device.address.empty() ? device.serial : device.address;
}

std::string lock_name(const DeviceIdentity& opened) {
  // One piece of hardware may go by several ids of its maker.
  constexpr std::string_view families[] = {"force-dimension"};
  std::string kind = opened.id;
  for (const std::string_view family : families) {
    if (kind.starts_with(family)) kind = family;
  }
  return kind + "-" + (opened.serial.empty() ? "any" : opened.serial);
}

DeviceLock::DeviceLock(const MappedDevice& sensor)
    : DeviceLock(sensor.id, sensor.id + "-" + (lock_name(sensor).empty() ? "any" : lock_name(sensor)), 0) {}

DeviceLock::DeviceLock(const DeviceIdentity& opened, pid_t holder)
    : DeviceLock(opened.id + " " + opened.serial, lock_name(opened), holder) {}

DeviceLock::DeviceLock(const std::string& device, const std::string& name, pid_t holder) {
  std::string file = name + ".lock";
  for (char& c : file) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
  }
  std::filesystem::path folder;
  const int folder_fd = open_lock_folder(folder);
  path_ = folder / file;
  descriptor_ = open_lock_file(folder_fd, file);
  const int error = errno;
  ::close(folder_fd);
  if (descriptor_ < 0) throw unusable(path_, std::strerror(error));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    char who[32] = {};
    const auto n = ::pread(descriptor_, who, sizeof who - 1, 0);
    ::close(descriptor_);
    throw DeviceError(DeviceStatus::busy,
                      fmt::format("{}: another run has it{}", device, n > 0 ? fmt::format(" (process {})", who) : ""),
                      "end that run first: a device serves one program alone");
  }
  const auto pid = std::to_string(holder != 0 ? holder : ::getpid());
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, pid.data(), pid.size(), 0) < 0) {
    // Only the message to a second run suffers.
  }
}

DeviceLock::~DeviceLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace touchstone::hil
