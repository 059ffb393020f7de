#include <fmt/format.h>

#include <charconv>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/atomic_file.h"
#include "harness/baseline/acceptance.h"
#include "harness/baseline/golden_file.h"
#include "harness/baseline/golden_summary.h"
#include "harness/pipeline/golden/case_runner.h"
#include "harness/pipeline/golden/noise_floor.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/model.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::apps {
namespace {

struct GoldenCommandOptions {
  GoldenOptions golden;
  std::string reason;
  std::string to;
  std::vector<std::string> programs;
  std::string json;
};

// The pending results of the chosen cases and model.
std::vector<PendingResult> chosen_pending(const GoldenOptions& options) {
  auto pending = pending_results(options.out);
  std::erase_if(pending, [&](const PendingResult& p) {
    const bool named = options.cases.empty() || std::ranges::find(options.cases, p.case_name) != options.cases.end();
    return !named || (!options.model.empty() && p.model != options.model);
  });
  return pending;
}

ExitStatus review(const GoldenCommandOptions& options) {
  const auto pending = chosen_pending(options.golden);
  for (const auto& p : pending) {
    fmt::print("{}", read_file(p.folder / "table.txt"));
    for (const char* const picture : {"golden.png", "obtained.png", "difference.png"}) {
      if (std::filesystem::exists(p.folder / picture)) fmt::print("  {}\n", (p.folder / picture).string());
    }
    fmt::print("  to make it the golden: touchstone golden accept {} --model {} --reason '...' --out {}\n\n",
               p.case_name, p.model, options.golden.out);
  }
  fmt::print("{} results wait for a decision in {}\n", pending.size(), options.golden.out);
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

// `changed` has other operations than the summary knows so far; the other models keep theirs.
void write_summary(const GoldenCase& golden, const std::string& changed, std::optional<RunOperations> operations) {
  std::map<std::string, GoldenSummary> summaries;
  const auto known = load_operations(golden.summary_file());
  for (const auto& [model, text] : golden.models) {
    if (!std::filesystem::exists(golden.expected(model))) continue;
    GoldenSummary& summary = summaries[model] = summarise(load_rendered(golden.expected(model)));
    const auto found = known.find(model);
    if (model == changed) {
      summary.operations = operations;
    } else if (found != known.end()) {
      summary.operations = found->second;
    }
  }
  write_file(golden.summary_file(), summaries_to_json(golden.name, summaries), Replace::inputs_too);
}

std::optional<RunOperations> operations_of(const Provenance& provenance) {
  RunOperations operations;
  const auto read = [&](const char* name, std::uint64_t& value) {
    const auto found = provenance.find(name);
    if (found == provenance.end()) return false;
    const std::string& text = found->second;
    return std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc();
  };
  if (!read("operations", operations.total) || !read("operations_max_step", operations.max_per_step))
    return std::nullopt;
  return operations;
}

bool same_bits(const std::filesystem::path& a, const std::filesystem::path& b) {
  return std::filesystem::exists(a) && std::filesystem::exists(b) &&
         summarise(load_rendered(a)).sha256 == summarise(load_rendered(b)).sha256;
}

ExitStatus accept(const GoldenCommandOptions& options) {
  if (options.reason.find_first_not_of(" \t") == std::string::npos)
    throw UsageError("--reason: say why this becomes the golden");
  if (const auto refused = acceptance_refused(options.golden.folder()))
    throw UsageError(fmt::format("not accepted: {}", *refused));
  const auto pending = chosen_pending(options.golden);
  if (pending.empty())
    throw UsageError(fmt::format("nothing to accept: no failed result of these cases in {}; run: touchstone check",
                                 options.golden.out));
  for (const auto& p : pending) {
    const GoldenCase golden = load_case(options.golden.folder() / p.case_name);
    if (!golden.models.contains(p.model))
      throw UsageError(fmt::format("the case {} has no model {}", p.case_name, p.model));
    Provenance run = read_provenance(p.obtained());
    if (const auto refused = run_refused(run))
      throw UsageError(fmt::format("{} {}: not accepted: {}", p.case_name, p.model, *refused));
    Provenance changes{{"reason", options.reason}};
    // Which file it was says its hash; where it lay is of this machine.
    if (const auto library = run.find("plugin_library"); library != run.end())
      changes["plugin_library"] = std::filesystem::path(library->second).filename().string();
    const bool before = std::filesystem::exists(golden.expected(p.model));
    // Where only the operations are other ones, the trajectory stays as it is, with what is known of its origin.
    const bool same = before && same_bits(p.obtained(), golden.expected(p.model));
    if (!same) copy_golden(p.obtained(), golden.expected(p.model), changes);
    write_summary(golden, p.model, operations_of(run));
    clear_result_folder(result_folder(options.golden.out, p.case_name, p.model));
    fmt::print("{} {} {}\n", same ? "operations" : before ? "replaced" : "new", p.case_name, p.model);
  }
  return ExitStatus::passed;
}

// The case as files that any version of the program can replay, by the interface that stays.
ExitStatus export_case(const GoldenCommandOptions& options) {
  const auto cases = options.golden.load();
  if (cases.size() != 1) throw UsageError("export: name one case");
  const GoldenCase& golden = cases.front();
  ensure_writable_folder(options.to);
  const std::filesystem::path to = options.to;
  save_mesh(case_mesh(synthetic::built_in_generators(), golden), to / "mesh.obj");
  save_trajectory(to / "trajectory.csv", case_trajectory(synthetic::built_in_generators(), golden));
  for (const std::string& model : options.golden.models_of(golden)) {
    write_file(to / (model + ".json"), model_to_json(parse_model(golden.models.at(model), golden.name)));
    if (std::filesystem::exists(golden.expected(model))) copy_golden(golden.expected(model), to / (model + ".h5"), {});
  }
  fmt::print("{}\n", to.string());
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
      add("export", "Write a case as mesh, trajectory and models for touchstone replay", export_case);
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
