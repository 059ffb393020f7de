// The catalogue of commands: a new one is a file `command_<name>.cc` and a line here and in commands().
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "apps/command.h"

namespace touchstone::apps {

void add_bisect(CLI::App& program, Run& run);
void add_check(CLI::App& program, Run& run);
void add_compare(CLI::App& program, Run& run);
void add_completion(CLI::App& program, Run& run);
void add_convert(CLI::App& program, Run& run);
void add_doctor(CLI::App& program, Run& run);
void add_discrepancy(CLI::App& program, Run& run);
void add_fit(CLI::App& program, Run& run);
void add_formats(CLI::App& program, Run& run);
void add_golden(CLI::App& program, Run& run);
void add_evaluate(CLI::App& program, Run& run);
void add_list(CLI::App& program, Run& run);
void add_perceive(CLI::App& program, Run& run);
void add_replay(CLI::App& program, Run& run);
void add_scorecard(CLI::App& program, Run& run);
void add_version(CLI::App& program, Run& run);

// Those that need no heavy library. The program `touchstone` has them itself and becomes another file for every
// other one: loading the libraries of fitting, archives and devices takes longer than a comparison.
inline constexpr std::array<std::string_view, 6> light_command_names{"check",  "compare",   "golden",
                                                                     "replay", "scorecard", "version"};
// All others of commands(): what is none of both may be an extra, which `touchstone` becomes without their libraries.
inline constexpr std::array<std::string_view, 10> heavy_command_names{
    "bisect", "completion", "convert", "discrepancy", "doctor", "evaluate", "fit", "formats", "list", "perceive"};
inline std::vector<AddCommand> light_commands() {
  return {add_check, add_compare, add_golden, add_replay, add_scorecard, add_version};
}

// One to a line, so that lines from several hands merge.
// clang-format off
inline std::vector<AddCommand> commands() {
  return {
      add_bisect,
      add_check,
      add_compare,
      add_completion,
      add_convert,
      add_doctor,
      add_discrepancy,
      add_fit,
      add_formats,
      add_golden,
      add_evaluate,
      add_list,
      add_perceive,
      add_replay,
      add_scorecard,
      add_version,
  };
}
// clang-format on

}  // namespace touchstone::apps
