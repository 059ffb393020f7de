// Runs a command to its end in a process group of its own, so that an interrupt ends all that it started.
#pragma once

#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::bisection {

struct ChildCommand {
  std::vector<std::string> words;                                // looked up in PATH, run without a shell
  std::filesystem::path folder;                                  // empty: where this process is
  std::vector<std::pair<std::string, std::string>> environment;  // in addition to this process's
  std::filesystem::path out;                                     // standard output goes there; empty: into `log` too
  std::filesystem::path log;                                     // error output is added to it; empty: dropped
};

class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

// Its exit status, or 128 plus the signal that ended it; 127 when it cannot be started. Throws Interrupted soon after
// `stop` becomes true, once the whole group is gone.
int run_child(const ChildCommand& command, const std::atomic<bool>& stop);

}  // namespace touchstone::bisection
