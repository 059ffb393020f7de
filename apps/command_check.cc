#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <vector>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/pipeline/golden/case_runner.h"
#include "harness/report/test_summary.h"

namespace touchstone::apps {
namespace {

struct CheckOptions {
  GoldenOptions golden;
  bool ctest = false;
  bool fail_on_drift = false;
  std::string verdict = "exact";
  FeltTolerance felt;
  bool annotations = false;
  std::string junit, markdown;
};

struct CheckCounts {
  std::size_t passed = 0, failed = 0, drifted = 0, skipped = 0;
  std::vector<CheckedTest> tests;  // for other programs
};

CheckedTest for_others(const GoldenCase& golden, const std::string& model, const CheckResult& result, bool good) {
  CheckedTest test{golden.name,  model, good, 0.0, std::string(to_string(result.comparison.verdict)),
                   result.table, {},    {}};
  if (good) return test;
  if (result.passed()) test.verdict = "drift, asked to fail";
  test.file = std::filesystem::path(golden.folder / "case.json").lexically_proximate(std::filesystem::current_path());
  for (const char* const name : {"golden.png", "obtained.png", "difference.png"}) {
    if (!result.left_in.empty() && std::filesystem::exists(result.left_in / name))
      test.pictures.push_back(result.left_in / name);
  }
  return test;
}

void write_for_others(const CheckOptions& options, const std::vector<CheckedTest>& tests) {
  if (!options.junit.empty()) write_file(options.junit, tests_to_junit("golden", tests));
  if (!options.markdown.empty()) {
    const auto base = std::filesystem::absolute(options.markdown).parent_path();
    write_file(options.markdown, tests_to_markdown("Golden cases", tests, base));
  }
  if (options.annotations) fmt::print("{}", tests_to_github_annotations(tests));
}

void check_one(const GoldenCase& golden, const std::string& model, const CheckOptions& options, const CaseCheck& how,
               CheckCounts& counts) {
  const auto began = std::chrono::steady_clock::now();
  const CheckResult result = check_case(built_in_catalogues(), golden, model, how);
  if (!result.skipped.empty()) {
    counts.skipped += 1;
    fmt::print("skipped  {} {}: {}\n", golden.name, model, result.skipped);
    counts.tests.push_back({golden.name, model, false, 0.0, "", "", golden.folder / "case.json", {}, result.skipped});
    return;
  }
  const Comparison& comparison = result.comparison;
  const bool drift = comparison.drift > 0;
  const bool drift_fails = drift && options.fail_on_drift && result.same_cpu;
  counts.drifted += drift ? 1 : 0;
  const bool good = result.passed() && !drift_fails;
  (good ? counts.passed : counts.failed) += 1;
  counts.tests.push_back(for_others(golden, model, result, good));
  counts.tests.back().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  if (result.felt) {
    fmt::print("{:<8} {} {}: {}\n", good ? "felt" : "noticed", golden.name, model,
               to_sentence(*result.felt, options.felt));
  } else {
    fmt::print("{:<8} {} {}: uses {:.3g}% of the tolerance, bits differ in {} of {} rows{}\n",
               to_string(comparison.verdict), golden.name, model, 100.0 * comparison.tolerance_used(), comparison.drift,
               comparison.expected_rows, drift_fails ? " (drift, asked to fail)" : "");
  }
  if (!result.passed()) fmt::print("{}  left in {}\n", result.table, result.left_in.string());
}

ExitStatus check_command(const CheckOptions& options) {
  if (options.verdict != "exact" && options.verdict != "felt")
    throw UsageError(fmt::format("--verdict {}: exact or felt was expected", options.verdict));
  if (!(options.felt.jnd > 0.0 && options.felt.epsilon_m >= 0.0))
    throw UsageError("--felt-tolerance must be above 0, --epsilon at least 0");
  const auto cases = options.golden.load();
  CaseCheck how{options.golden.out, options.ctest, options.golden.change_model(), std::nullopt};
  if (options.verdict == "felt") how.felt = options.felt;
  CheckCounts counts;
  for (const GoldenCase& golden : cases) {
    for (const std::string& model : options.golden.models_of(golden)) check_one(golden, model, options, how, counts);
  }
  write_for_others(options, counts.tests);
  fmt::print("{} passed, {} failed, {} drifted{}\n", counts.passed, counts.failed, counts.drifted,
             counts.skipped > 0 ? fmt::format(", {} skipped", counts.skipped) : "");
  if (counts.failed > 0) fmt::print("to look at the failures: touchstone golden review --out {}\n", options.golden.out);
  if (counts.failed == 0 && counts.passed == 0 && counts.skipped > 0) return ExitStatus::skipped;
  return counts.failed == 0 ? ExitStatus::passed : ExitStatus::failed;
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
  command
      ->add_option("--verdict", options->verdict,
                   "exact: within the case's tolerance of its golden; felt: a person would not notice the difference "
                   "from the right answer")
      ->capture_default_str();
  command
      ->add_option("--felt-tolerance", options->felt.jnd,
                   "For felt: the largest error, in just noticeable differences of the right force")
      ->capture_default_str();
  command
      ->add_option("--epsilon", options->felt.epsilon_m,
                   "For felt: a length [m] that the renderer does not tell apart; times the stiffness it is allowed "
                   "on top")
      ->capture_default_str();
  command->add_option("--junit", options->junit, "Write the results as JUnit XML, for GitLab, Jenkins and others");
  command->add_option("--markdown", options->markdown, "Write a summary with pictures as Markdown, for a job's page");
  command->add_flag("--annotations", options->annotations,
                    "Print failures as GitHub's workflow commands, which mark files");
  command->footer(
      "Accuracy (beyond tolerance) always fails; drift (bits) is reported. Writes nothing into the golden folder.\n"
      "Examples:\n"
      "  touchstone check\n"
      "  touchstone check sphere-scan --model god-object --fail-on-drift\n"
      "  touchstone check --junit golden.xml --markdown golden.md\n"
      "  touchstone check plane-taps --model spring-linear --plugin ./libmine.so --renderer mine\n"
      "  touchstone check --model god-object --plugin ./libmine.so --renderer mine --verdict felt --epsilon 1e-7");
  command->callback([options, &run] { run = [options] { return check_command(*options); }; });
}

}  // namespace touchstone::apps
