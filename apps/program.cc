#include "apps/program.h"

#include <fmt/format.h>

#include <exception>
#include <new>

#include "harness/base/half_files.h"
#include "harness/base/version.h"

namespace touchstone::apps {
namespace {

std::vector<std::string>& called_as() {
  static std::vector<std::string> words;
  return words;
}

int run(int argc, char** argv, const std::vector<AddCommand>& commands) {
  CLI::App program{
      "Touchstone tells whether a haptic renderer is right: it replays measured probe trajectories through "
      "renderers and compares forces, positions and cost with the measured truth.",
      "touchstone"};
  program.require_subcommand(1);
  program.set_version_flag("--version", build_info().version);
  program.footer(
      "Exit status: 0 passed, 1 a regression or a disagreement beyond tolerance, 2 usage, 3 bad data, 77 skipped.");
  Run chosen;
  for (const auto add : commands) add(program, chosen);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = program.exit(error);
    return status == 0 ? 0 : static_cast<int>(ExitStatus::usage);
  }
  return static_cast<int>(chosen());
}

}  // namespace

const std::vector<std::string>& command_line() { return called_as(); }

int run_program(int argc, char** argv, const std::vector<AddCommand>& commands) {
  called_as().assign(argv, argv + argc);
  remove_half_files_when_interrupted();
  try {
    return run(argc, argv, commands);
  } catch (const Error& error) {
    fmt::print(stderr, "touchstone: {}\n", error.what());
    return static_cast<int>(error.status());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "touchstone: out of memory\n");
    return static_cast<int>(ExitStatus::bad_data);
  } catch (const std::exception& error) {
    fmt::print(stderr, "touchstone: internal error, please report it: {}\n", error.what());
    return 70;
  }
}

}  // namespace touchstone::apps
