#include <fmt/format.h>

#include <optional>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/freed_memory.h"
#include "harness/golden/comparison/compared_files.h"
#include "harness/golden/comparison/comparison_report.h"
#include "harness/golden/comparison/error_regimes.h"

namespace touchstone::apps {
namespace {

struct CompareOptions {
  std::string expected, obtained, repeat, tolerance, json, print;
  bool where = false, flip_force = false;
};

ExitStatus compare_command(const CompareOptions& options) {
  take_memory_in_huge_pages(std::size_t{16} << 20);
  golden::CompareRequest request{options.expected, options.obtained, options.repeat, std::nullopt, options.flip_force};
  if (!options.tolerance.empty()) request.tolerance = golden::load_tolerance(options.tolerance);
  const golden::ComparedFiles files = compare_files(request);
  if (!options.json.empty()) write_file(options.json, files.json());
  if (options.print.empty()) {
    fmt::print("{}", files.text());
    if (options.where) fmt::print("{}", to_table(locate_error(files.expected, files.obtained)));
  } else {
    fmt::print("{:.17g}\n", files.metric(options.print));
  }
  for (const std::string& line : files.explanations()) fmt::print(stderr, "warning: {}\n", line);
  if (files.passed) return ExitStatus::passed;
  return files.comparison.bad_data ? ExitStatus::bad_data : ExitStatus::failed;
}

}  // namespace

void add_compare(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("compare", "Compare two recordings, rendered files or goldens");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("EXPECTED", options->expected, "CSV (also .gz) or HDF5")->required();
  command->add_option("OBTAINED", options->obtained, "CSV (also .gz) or HDF5")->required();
  command->add_option("--tolerance", options->tolerance,
                      "Tolerance file (touchstone-tolerance/1); without it 1e-6 N, 1e-7 m, relative 1e-6");
  command->add_option("--repeat", options->repeat,
                      "A second recording of the same motion as EXPECTED: what they differ by is the floor; without "
                      "--tolerance an RMS error of force and position within it passes");
  command->add_flag("--flip-force", options->flip_force, "OBTAINED has the force BY the probe: negate it");
  command->add_option("--json", options->json, "Write the comparison as JSON");
  command->add_option("--print", options->print, "Print this metric alone, for instance force_rms_N");
  command->add_flag("--where", options->where,
                    "Say by axis, by what the tip does and where on the object the force error sits");
  command->footer(
      "Passes only when both have the same columns and number of rows, every value is finite and every error is "
      "within\n"
      "tolerance. Exit status 1: beyond tolerance, or a column or rows that only one side has; 3: a NaN or nothing to "
      "compare.\n"
      "If it fails, faults of OBTAINED are tried (force reversed or in another frame, unit, clock) and named with "
      "their "
      "repair.\n"
      "Examples:\n"
      "  touchstone compare golden.h5 rendered.csv\n"
      "  touchstone compare expected.csv obtained.csv --tolerance tolerance.json --json comparison.json\n"
      "  touchstone compare expected.csv obtained.csv --print force_rms_N\n"
      "  touchstone compare run1.csv rendered.csv --repeat run2.csv");
  command->callback([options, &run] { run = [options] { return compare_command(*options); }; });
}

}  // namespace touchstone::apps
