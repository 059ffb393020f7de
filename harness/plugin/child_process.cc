#include "harness/plugin/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "harness/rendering/renderer_failed.h"

namespace touchstone::plugin {
namespace {

constexpr int memory_fd = 3;
constexpr int lifeline_fd = 4;
// How long a child may take to end when asked to.
constexpr std::chrono::milliseconds patience{500};

// A copy above the numbers that the child uses, so that handing one over does not close another.
OwnedFd out_of_the_way(int fd) { return OwnedFd(::fcntl(fd, F_DUPFD_CLOEXEC, 10)); }

}  // namespace

OwnedFd& OwnedFd::operator=(OwnedFd&& other) noexcept {
  if (this != &other) {
    reset();
    fd_ = other.release();
  }
  return *this;
}

int OwnedFd::release() noexcept { return std::exchange(fd_, -1); }

void OwnedFd::reset() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const OwnedFd& memory) {
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    throw rendering::RendererFailed(fmt::format("no pipe for the process of a plug-in: {}", std::strerror(errno)));
  }
  const OwnedFd low(ends[0]);
  lifeline_ = OwnedFd(ends[1]);
  const OwnedFd listening = out_of_the_way(low.get());
  const OwnedFd shared = out_of_the_way(memory.get());

  std::vector<char*> words;
  std::string name = program.string();
  std::vector<std::string> copies = arguments;
  words.push_back(name.data());
  for (std::string& word : copies) words.push_back(word.data());
  words.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, shared.get(), memory_fd);
  ::posix_spawn_file_actions_adddup2(&actions, listening.get(), lifeline_fd);
  // A plug-in's own words must not stand among results.
  ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  const int error = ::posix_spawn(&pid_, name.c_str(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    pid_ = -1;
    throw rendering::RendererFailed(
        fmt::format("{}: the process for a plug-in does not start: {}", name, std::strerror(error)));
  }
}

ChildProcess::~ChildProcess() {
  lifeline_.reset();
  const auto begin = std::chrono::steady_clock::now();
  while (!ended() && std::chrono::steady_clock::now() - begin < patience) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  kill();
}

bool ChildProcess::ended() noexcept {
  if (status_ || pid_ < 0) return true;
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) == pid_) status_ = status;
  return status_.has_value();
}

void ChildProcess::kill() noexcept {
  if (ended()) return;
  ::kill(pid_, SIGKILL);
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  status_ = status;
}

std::string ChildProcess::how_it_ended() const {
  if (!status_) return "is still running";
  if (WIFSIGNALED(*status_)) {
    const int signal = WTERMSIG(*status_);
    const char* const name = ::sigabbrev_np(signal);
    return fmt::format("crashed (SIG{}: {})", name == nullptr ? "?" : name, ::sigdescr_np(signal));
  }
  return fmt::format("ended its process with exit status {}", WEXITSTATUS(*status_));
}

}  // namespace touchstone::plugin
