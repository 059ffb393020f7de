// Memory that this program and a child process see at the same time.
#pragma once

#include <cstddef>

#include "harness/plugin/child_process.h"

namespace touchstone::plugin {

class SharedMemory {
 public:
  // Zeroed. Throws RendererFailed when there is not enough.
  explicit SharedMemory(std::size_t size);
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const OwnedFd& fd() const noexcept { return fd_; }

 private:
  std::size_t size_;
  OwnedFd fd_;
  std::byte* data_ = nullptr;
};

}  // namespace touchstone::plugin
