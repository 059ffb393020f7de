// Runs another program to its end: a build, gnuplot, git, ssh-keygen, this program in a fresh process.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace touchstone {

// What the program prints: shown where this process prints, kept for the caller, dropped, or, what is no error, sent
// where its errors go.
enum class Printed : std::uint8_t { shown, kept, dropped, with_errors };

struct OtherProgram {
  std::vector<std::string> words;  // the first is looked up in PATH; run without a shell
  Printed out = Printed::shown;
  Printed err = Printed::shown;
  std::filesystem::path input = {};     // its standard input; empty: this process's
  bool without_terminal = false;        // in a session of its own: what would ask for a password fails instead
  bool ends_with_this = false;          // SIGTERM when this process ends, however it does
  std::filesystem::path out_file = {};  // written anew, in the place of `out`
  std::filesystem::path err_file = {};  // added to, in the place of `err`
  std::filesystem::path folder = {};    // where it runs; empty: where this process is
  std::vector<std::pair<std::string, std::string>> environment = {};  // beside this process's
  // It gets a process group of its own. Soon after this becomes true the group is ended, with all that the program
  // started, and run_other() throws Interrupted.
  const std::atomic<bool>* stop = nullptr;
};

struct ProgramEnd {
  int status = 0;        // exit status, or 128 plus the signal that ended it
  std::string out, err;  // where they were to be kept
};

class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

// Nothing where it cannot be started.
std::optional<ProgramEnd> run_other(const OtherProgram& program);

}  // namespace touchstone
