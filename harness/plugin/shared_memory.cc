#include "harness/plugin/shared_memory.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "harness/rendering/renderer_failed.h"

namespace touchstone::plugin {

SharedMemory::SharedMemory(std::size_t size) : size_(size), fd_(::memfd_create("touchstone-plugin", MFD_CLOEXEC)) {
  void* mapped = MAP_FAILED;
  if (fd_.get() >= 0 && ::ftruncate(fd_.get(), static_cast<off_t>(size)) == 0) {
    mapped = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd_.get(), 0);
  }
  if (mapped == MAP_FAILED) {
    throw rendering::RendererFailed(
        fmt::format("{} bytes to share with the process of a plug-in: {}", size, std::strerror(errno)));
  }
  data_ = static_cast<std::byte*>(mapped);
}

SharedMemory::~SharedMemory() { ::munmap(data_, size_); }

}  // namespace touchstone::plugin
