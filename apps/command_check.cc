#include <fmt/format.h>

#include <cmath>

#include "apps/commands.h"
#include "apps/golden_options.h"
#include "apps/golden_runner.h"
#include "harness/base/progress.h"

namespace touchstone::apps {
namespace {

struct CheckOptions {
  GoldenOptions golden;
  bool ctest = false;
  bool fail_on_drift = false;
};

ExitStatus check_command(const CheckOptions& options) {
  const auto cases = options.golden.load();
  const ChangeModel change = options.golden.change_model();
  std::size_t passed = 0;
  std::size_t failed = 0;
  std::size_t drifted = 0;
  std::string left;
  for (const GoldenCase& golden : cases) {
    for (const std::string& model : options.golden.models_of(golden)) {
      const CheckResult result = check_case(golden, model, options.golden.out, options.ctest, change);
      const Comparison& comparison = result.comparison;
      const bool drift = comparison.drift > 0;
      const bool drift_fails = drift && options.fail_on_drift && result.same_cpu;
      drifted += drift ? 1 : 0;
      const bool good = passes(comparison.verdict) && !drift_fails;
      (good ? passed : failed) += 1;
      fmt::print("{:<8} {} {}: uses {:.3g}% of the tolerance, bits differ in {} of {} rows{}\n",
                 to_string(comparison.verdict), golden.name, model, 100.0 * comparison.tolerance_used(),
                 comparison.drift, comparison.expected_rows, drift_fails ? " (drift, asked to fail)" : "");
      if (!passes(comparison.verdict)) fmt::print("{}  left in {}\n", result.table, result.left_in.string());
    }
  }
  fmt::print("{} passed, {} failed, {} drifted\n", passed, failed, drifted);
  if (failed > 0) fmt::print("to look at the failures: touchstone golden review --out {}\n", options.golden.out);
  return failed == 0 ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_check(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("check", "Run golden cases and compare with what they must give");
  auto options = std::make_shared<CheckOptions>();
  options->golden.add_to(*command);
  command->add_flag("--ctest", options->ctest,
                    "Print measurements and pictures for ctest and CDash, with the time of the steps");
  command->add_flag("--fail-on-drift", options->fail_on_drift,
                    "Fail when any bit differs, where the processor is the one that made the golden");
  command->footer(
      "Accuracy (beyond tolerance) always fails; drift (bits) is reported. Writes nothing into the golden folder.\n"
      "Examples:\n"
      "  touchstone check\n"
      "  touchstone check sphere-scan --model god-object --fail-on-drift\n"
      "  touchstone check plane-taps --model spring-linear --plugin ./libmine.so --renderer mine");
  command->callback([options, &run] { run = [options] { return check_command(*options); }; });
}

}  // namespace touchstone::apps
