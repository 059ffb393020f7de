// Runs another program to its end: gnuplot, git, ssh-keygen, this program in a fresh process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone {

// What the program prints: shown where this process prints, kept for the caller, or dropped.
enum class Printed : std::uint8_t { shown, kept, dropped };

struct OtherProgram {
  std::vector<std::string> words;  // the first is looked up in PATH; run without a shell
  Printed out = Printed::shown;
  Printed err = Printed::shown;
  std::filesystem::path input = {};  // its standard input; empty: this process's
  bool without_terminal = false;     // in a session of its own: what would ask for a password fails instead
  bool ends_with_this = false;       // SIGTERM when this process ends, however it does
};

struct ProgramEnd {
  int status = 0;        // exit status, or 128 plus the signal that ended it
  std::string out, err;  // where they were to be kept
};

// Nothing where it cannot be started.
std::optional<ProgramEnd> run_other(const OtherProgram& program);

}  // namespace touchstone
