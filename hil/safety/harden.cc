#include "safety/harden.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <string_view>

namespace touchstone::hil {
namespace {

bool write_proc(const char* path, std::string_view text) {
  const int fd = ::open(path, O_WRONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::close(fd);
  return written;
}

}  // namespace

std::string harden(int priority, LockedMemory memory) {
  // A terminal's Ctrl-C reaches the whole group: the guard outlives it to bring the device down.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) std::signal(signal, SIG_IGN);
  std::string missing;
  const auto want = [&](bool had, const char* what) {
    if (!had) missing += (missing.empty() ? "" : ", ") + std::string(what);
  };
  sched_param parameters{};
  parameters.sched_priority = priority;
  want(::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0, "real-time scheduling");
  ::prctl(PR_SET_TIMERSLACK, 1UL);
  want(::mlockall(memory == LockedMemory::present ? MCL_CURRENT : MCL_CURRENT | MCL_FUTURE) == 0, "locked memory");
  want(write_proc("/proc/self/oom_score_adj", "-1000"), "protection from the out-of-memory killer");
  return missing;
}

}  // namespace touchstone::hil
