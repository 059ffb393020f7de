// Programs of a bisection: they read nothing, print into a log, and end with all that they started when the search
// stops.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "harness/base/other_program.h"
#include "harness/bisection/bisection.h"

namespace touchstone::bisection {

inline OtherProgram logged_program(const std::filesystem::path& log, const std::atomic<bool>& stop) {
  OtherProgram program;
  program.out = Printed::with_errors;
  program.input = "/dev/null";
  program.err_file = log;
  program.stop = &stop;
  return program;
}

// In the commit's source folder, with what the user's commands may refer to.
inline OtherProgram shell_command(const std::string& command, const BuiltCommit& built, const std::atomic<bool>& stop) {
  OtherProgram program = logged_program(built.log, stop);
  program.words = {"sh", "-c", command};
  program.folder = built.source;
  program.environment = built.environment;
  return program;
}

inline bool succeeds(const OtherProgram& program) {
  const auto end = run_other(program);
  return end && end->status == 0;
}

}  // namespace touchstone::bisection
