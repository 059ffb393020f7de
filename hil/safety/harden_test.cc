// What a guard asks of the machine, as the kernel has it in /proc, and what it says it did not get.
#include "safety/harden.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <string>

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

// A sanitizer needs its memory unlocked and answers mlockall itself.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_can_be_locked = false;
#else
constexpr bool memory_can_be_locked = true;
#endif

std::string value_in(const char* file, const std::string& key) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line)) {
    if (line.rfind(key, 0) == 0) return line.substr(key.size());
  }
  return {};
}

// What a child has to say, since hardening cannot be taken back.
std::string in_a_child(const std::function<std::string()>& act) {
  int ends[2];
  if (::pipe(ends) != 0) return "pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string said = act();
    const bool written = ::write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size());
    ::_exit(written ? 0 : 1);
  }
  ::close(ends[1]);
  std::string said;
  char bytes[256];
  for (ssize_t n = 0; (n = ::read(ends[0], bytes, sizeof bytes)) > 0;) said.append(bytes, static_cast<std::size_t>(n));
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return said;
}

TEST(Harden, WhatItDoesNotMissTheKernelConfirms) {
  const std::string said = in_a_child([] {
    const std::string missing = harden(10, LockedMemory::present);
    const auto has = [&](const char* what) { return missing.find(what) == std::string::npos; };
    std::string wrong;
    if (has("real-time") && ::sched_getscheduler(0) != SCHED_FIFO) wrong += "not SCHED_FIFO; ";
    if (memory_can_be_locked && has("locked memory") &&
        value_in("/proc/self/status", "VmLck:").find_first_of("123456789") == std::string::npos)
      wrong += "nothing locked; ";
    std::ifstream score("/proc/self/oom_score_adj");
    int adjusted = 0;
    score >> adjusted;
    if (has("out-of-memory") && adjusted != -1000) wrong += "not protected; ";
    return wrong + "missing: " + missing;
  });
  EXPECT_THAT(said, ::testing::StartsWith("missing: "));
}

TEST(Harden, SaysWhatAUserWithoutRightsDoesNotGet) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs to become a user without rights: run as root";
  const std::string said = in_a_child([]() -> std::string {
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_MEMLOCK, &none);
    ::setrlimit(RLIMIT_RTPRIO, &none);
    constexpr uid_t nobody = 65534;
    if (::setgid(nobody) != 0 || ::setuid(nobody) != 0) return "cannot become another user";
    return harden(10, LockedMemory::present);
  });
  EXPECT_THAT(said, HasSubstr("real-time scheduling"));
  if (memory_can_be_locked) {
    EXPECT_THAT(said, HasSubstr("locked memory"));
  }
  EXPECT_THAT(said, HasSubstr("protection from the out-of-memory killer"));
}

}  // namespace
}  // namespace touchstone::hil
