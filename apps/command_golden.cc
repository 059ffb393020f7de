#include <fmt/format.h>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/error.h"
#include "harness/baseline/acceptance.h"
#include "harness/baseline/golden_file.h"
#include "harness/pipeline/golden/case_runner.h"
#include "harness/pipeline/golden/golden_life.h"
#include "harness/pipeline/golden/noise_floor.h"

namespace touchstone::apps {
namespace {

struct GoldenCommandOptions {
  GoldenOptions golden;
  std::string reason;
  std::string to;
  std::vector<std::string> programs;
  std::string json;
};

ExitStatus review(const GoldenCommandOptions& options) {
  const GoldenOptions& golden = options.golden;
  fmt::print("{}", review_text(chosen_pending(golden.out, golden.cases, golden.model), golden.out));
  return ExitStatus::passed;
}

ExitStatus noise_floor(const GoldenCommandOptions& options) {
  if (options.programs.empty() && options.json.empty())
    throw UsageError("floor: give --program to measure, or --json to judge what was kept");
  const std::vector<GoldenCase> cases = options.golden.load();
  const auto floors = options.programs.empty() ? pipeline::judge_noise_floors(cases, options.json)
                                               : pipeline::measure_noise_floors(cases, options.golden.folder().string(),
                                                                                options.programs, options.json);
  fmt::print("{}", floors.text);
  return floors.status;
}

ExitStatus accept(const GoldenCommandOptions& options) {
  if (options.reason.find_first_not_of(" \t") == std::string::npos)
    throw UsageError("--reason: say why this becomes the golden");
  if (const auto refused = acceptance_refused(options.golden.folder()))
    throw UsageError(fmt::format("not accepted: {}", *refused));
  const auto pending = chosen_pending(options.golden.out, options.golden.cases, options.golden.model);
  if (pending.empty())
    throw UsageError(fmt::format("nothing to accept: no failed result of these cases in {}; run: touchstone check",
                                 options.golden.out));
  for (const auto& p : pending) {
    const std::string what = accept_result(p, options.golden.folder(), options.golden.out, options.reason);
    fmt::print("{} {} {}\n", what, p.case_name, p.model);
  }
  return ExitStatus::passed;
}

ExitStatus export_command(const GoldenCommandOptions& options) {
  const auto cases = options.golden.load();
  if (cases.size() != 1) throw UsageError("export: name one case");
  export_case(synthetic::built_in_generators(), cases.front(), options.golden.models_of(cases.front()), options.to);
  fmt::print("{}\n", std::filesystem::path(options.to).string());
  return ExitStatus::passed;
}

ExitStatus render(const GoldenCommandOptions& options) {
  const ChangeModel change = options.golden.change_model();
  for (const GoldenCase& golden : options.golden.load()) {
    for (const std::string& model : options.golden.models_of(golden)) {
      const CaseRun done = run_case(built_in_catalogues(), golden, model, false, change);
      write_golden(std::filesystem::path(options.to) / golden.name / (model + ".h5"), done.rendered, done.provenance);
    }
  }
  return ExitStatus::passed;
}

}  // namespace

void add_golden(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("golden", "Review and accept results of golden cases, measure their noise floor");
  command->require_subcommand(1);
  auto options = std::make_shared<GoldenCommandOptions>();
  const auto add = [&](const char* name, const char* what, ExitStatus (*function)(const GoldenCommandOptions&)) {
    auto* const sub = command->add_subcommand(name, what);
    options->golden.add_to(*sub);
    sub->callback([options, function, &run] { run = [options, function] { return function(*options); }; });
    return sub;
  };
  add("review", "Show every result that failed: numbers and pictures", review)
      ->footer("Example:\n  touchstone golden review");
  auto* const accepting = add("accept", "Make results that failed the new goldens", accept);
  accepting->add_option("--reason", options->reason, "Why; stands in the golden")->required();
  accepting->footer(
      "Takes the files that the failed runs left, so that what becomes the golden is what was looked at. Refused under "
      "CI\n"
      "and from a tree with uncommitted changes.\nExample:\n"
      "  touchstone golden accept sphere-scan --model god-object --reason 'friction acts inside the proxy step now'");
  auto* const exporting =
      add("export", "Write a case as mesh, trajectory and models for touchstone replay", export_command);
  exporting->add_option("--to", options->to, "Folder")->required();
  exporting->footer("Example:\n  touchstone golden export sphere-scan --to /tmp/case");
  auto* const rendering = add("render", "Run cases and keep the results, without comparing", render);
  rendering->add_option("--to", options->to, "Folder")->required();
  rendering->footer("Example:\n  touchstone golden render --to /tmp/here");
  auto* const floor =
      add("floor", "The noise floor: how far other builds of the program are from the goldens", noise_floor);
  floor->add_option("--program", options->programs, "Programs built by other compilers or with other flags");
  floor->add_option("--json", options->json, "Keep what was measured, or without --program: judge what was kept");
  floor->footer(
      "Each tolerance must be at least ten times the floor. ci/golden-floor builds the programs and keeps the result "
      "in\ngolden/noise-floor.json. Exit status 77: none is too tight, some are not measured.\nExamples:\n"
      "  touchstone golden floor --program build/clang/bin/touchstone --program build/fma/bin/touchstone\n"
      "  touchstone golden floor --json golden/noise-floor.json");
}

}  // namespace touchstone::apps
