#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <vector>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/check_tally.h"
#include "harness/report/test_summary.h"

namespace touchstone::apps {
using golden::CheckTally;
using golden::GoldenCase;

namespace {

struct CheckOptions {
  GoldenOptions golden;
  bool ctest = false;
  bool fail_on_drift = false;
  std::string verdict = "exact";
  golden::FeltTolerance felt;
  bool annotations = false;
  std::string junit, markdown;
};

void write_for_others(const CheckOptions& options, const std::vector<report::CheckedTest>& tests) {
  if (!options.junit.empty()) write_file(options.junit, tests_to_junit("golden", tests));
  if (!options.markdown.empty()) {
    const auto base = std::filesystem::absolute(options.markdown).parent_path();
    write_file(options.markdown, tests_to_markdown("Golden cases", tests, base));
  }
  if (options.annotations) fmt::print("{}", tests_to_github_annotations(tests));
}

// A case that cannot be run must not take the other cases' results with it, nor the report of them.
void check_or_say(const GoldenCase& golden, const std::string& model, const CheckOptions& options,
                  const golden::CaseCheck& how, CheckTally& tally) {
  try {
    const auto began = std::chrono::steady_clock::now();
    const golden::CheckResult result = check_case(built_in_catalogues(), golden, model, how);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    fmt::print("{}{}", tally.add(golden, model, result, took.count(), options.felt), result.measurements);
  } catch (const UsageError& error) {
    if (how.change) throw;  // of the options, which are the same for every case
    fmt::print(stderr, "{}", tally.add_unusable(golden.name, model, golden.folder, error.what()));
  } catch (const BadData& error) {
    fmt::print(stderr, "{}", tally.add_unusable(golden.name, model, golden.folder, error.what()));
  }
}

std::vector<GoldenCase> load_or_say(const CheckOptions& options) {
  try {
    return options.golden.load();
  } catch (const BadData& error) {
    CheckTally none;
    fmt::print(stderr, "{}", none.add_unusable("golden", "cases", options.golden.folder(), error.what()));
    write_for_others(options, none.tests());
    throw;
  }
}

ExitStatus check_command(const CheckOptions& options) {
  if (options.verdict != "exact" && options.verdict != "felt")
    throw UsageError(fmt::format("--verdict {}: exact or felt was expected", options.verdict));
  if (!(options.felt.jnd > 0.0 && options.felt.epsilon_m >= 0.0))
    throw UsageError("--felt-tolerance must be above 0, --epsilon at least 0");
  const auto cases = load_or_say(options);
  golden::CaseCheck how{options.golden.out, options.ctest, options.golden.change_model(), std::nullopt};
  if (options.verdict == "felt") how.felt = options.felt;
  how.fail_on_drift = options.fail_on_drift;
  CheckTally tally;
  std::size_t without = 0;
  for (const GoldenCase& golden : cases) {
    if (!options.golden.model.empty() && !golden.models.contains(options.golden.model)) {
      ++without;
      // A case that was asked for by its name must run.
      if (!options.golden.cases.empty())
        fmt::print(stderr, "{}",
                   tally.add_unusable(golden.name, options.golden.model, golden.folder, "the case has no such model"));
      continue;
    }
    for (const std::string& model : options.golden.models_of(golden)) check_or_say(golden, model, options, how, tally);
  }
  // Throws, with the models that the case has.
  if (without > 0 && without == cases.size()) golden::case_model(cases.front(), options.golden.model);
  write_for_others(options, tally.tests());
  fmt::print("{}", tally.counts_text());
  if (without > 0) fmt::print("cases without the model {}: {}\n", options.golden.model, without);
  if (tally.failed())
    fmt::print("to look at the failures, and to accept what was meant: touchstone golden review --golden {} --out {}\n",
               options.golden.folder().lexically_proximate(std::filesystem::current_path()).string(),
               options.golden.out);
  if (tally.unusable()) return ExitStatus::bad_data;
  if (tally.all_skipped()) return ExitStatus::skipped;
  return tally.failed() ? ExitStatus::failed : ExitStatus::passed;
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
