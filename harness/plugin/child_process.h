// The child process of a plug-in: started, watched, ended. What it prints goes to this program's stderr.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::plugin {

// A file descriptor that closes itself.
class OwnedFd {
 public:
  explicit OwnedFd(int fd = -1) noexcept : fd_(fd) {}
  OwnedFd(OwnedFd&& other) noexcept : fd_(other.release()) {}
  OwnedFd& operator=(OwnedFd&& other) noexcept;
  ~OwnedFd() { reset(); }
  [[nodiscard]] int get() const noexcept { return fd_; }
  int release() noexcept;
  void reset() noexcept;

 private:
  int fd_;
};

class ChildProcess {
 public:
  // Runs `program` with `arguments`; it sees `memory` as descriptor 3 and the read end of a pipe as descriptor 4, which
  // reports its end when this object, or this program, is gone. Throws RendererFailed when it cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, const OwnedFd& memory);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Whether it has ended by itself.
  [[nodiscard]] bool ended() noexcept;
  void kill() noexcept;
  // "crashed (SIGSEGV: ...)" or "ended its process with exit status 3".
  [[nodiscard]] std::string how_it_ended() const;

 private:
  pid_t pid_ = -1;
  OwnedFd lifeline_;
  std::optional<int> status_;
};

}  // namespace touchstone::plugin
