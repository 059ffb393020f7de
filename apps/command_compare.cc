#include <fmt/format.h>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/freed_memory.h"
#include "harness/baseline/column_file.h"
#include "harness/baseline/comparison_report.h"
#include "harness/baseline/error_regimes.h"

namespace touchstone::apps {
namespace {

struct CompareOptions {
  std::string expected, obtained, tolerance, json, print;
  bool where = false;
};

ExitStatus compare_command(const CompareOptions& options) {
  take_memory_in_huge_pages(std::size_t{16} << 20);
  const Tolerance tolerance = options.tolerance.empty() ? default_tolerance() : load_tolerance(options.tolerance);
  const auto [expected, obtained] = load_columns(options.expected, options.obtained);
  const Comparison comparison = compare(expected, obtained, tolerance);
  if (!options.json.empty()) write_file(options.json, to_json_text(comparison));
  if (options.print.empty()) {
    fmt::print("{}", to_table(comparison));
    if (options.where) fmt::print("{}", to_table(locate_error(expected, obtained)));
  } else {
    const auto metrics = metrics_of(comparison);
    const auto found =
        std::find_if(metrics.begin(), metrics.end(), [&](const auto& m) { return m.first == options.print; });
    if (found == metrics.end()) {
      std::string known;
      for (const auto& [name, value] : metrics) known += ' ' + name;
      throw BadData(
          fmt::format("this comparison has no metric '{}'; it has:{}\n{}", options.print, known, to_table(comparison)));
    }
    fmt::print("{:.17g}\n", found->second);
  }
  if (passes(comparison.verdict)) return ExitStatus::passed;
  return comparison.bad_data ? ExitStatus::bad_data : ExitStatus::failed;
}

}  // namespace

void add_compare(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("compare", "Compare two recordings, rendered files or goldens");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("EXPECTED", options->expected, "CSV (also .gz) or HDF5")->required();
  command->add_option("OBTAINED", options->obtained, "CSV (also .gz) or HDF5")->required();
  command->add_option("--tolerance", options->tolerance,
                      "Tolerance file (touchstone-tolerance/1); without it 1e-6 N, 1e-7 m, relative 1e-6");
  command->add_option("--json", options->json, "Write the comparison as JSON");
  command->add_option("--print", options->print, "Print this metric alone, for instance force_rms_N");
  command->add_flag("--where", options->where,
                    "Say by axis, by what the tip does and where on the object the force error sits");
  command->footer(
      "Passes only when both have the same columns and number of rows, every value is finite and every error is "
      "within\n"
      "tolerance. Exit status 1: beyond tolerance, or a column or rows that only one side has; 3: a NaN or nothing to "
      "compare.\n"
      "Examples:\n"
      "  touchstone compare golden.h5 rendered.csv\n"
      "  touchstone compare expected.csv obtained.csv --tolerance tolerance.json --json comparison.json\n"
      "  touchstone compare expected.csv obtained.csv --print force_rms_N");
  command->callback([options, &run] { run = [options] { return compare_command(*options); }; });
}

}  // namespace touchstone::apps
