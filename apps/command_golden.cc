#include <fmt/format.h>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/error.h"
#include "harness/base/named_values.h"
#include "harness/golden/acceptance.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/golden_file.h"
#include "harness/golden/golden_store.h"
#include "harness/golden/new_case.h"
#include "harness/golden/noise_floor.h"

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
  const auto folder = golden.folder().lexically_proximate(std::filesystem::current_path());
  fmt::print("{}", golden::review_text(golden::chosen_pending(golden.out, golden.cases, golden.model), folder.string(),
                                       golden.out));
  return ExitStatus::passed;
}

ExitStatus noise_floor(const GoldenCommandOptions& options) {
  if (options.programs.empty() && options.json.empty())
    throw UsageError("floor: give --program to measure, or --json to judge what was kept");
  const std::vector<golden::GoldenCase> cases = options.golden.load();
  const auto floors = options.programs.empty() ? golden::judge_noise_floors(cases, options.json)
                                               : golden::measure_noise_floors(cases, options.golden.folder().string(),
                                                                              options.programs, options.json);
  fmt::print("{}", floors.text);
  return floors.status;
}

ExitStatus accept(const GoldenCommandOptions& options) {
  if (options.reason.find_first_not_of(" \t") == std::string::npos)
    throw UsageError("--reason: say why this becomes the golden");
  if (const auto refused = golden::acceptance_refused(options.golden.folder()))
    throw UsageError(fmt::format("not accepted: {}", *refused));
  const auto pending = golden::chosen_pending(options.golden.out, options.golden.cases, options.golden.model);
  if (pending.empty())
    throw UsageError(fmt::format("nothing to accept: no failed result of these cases in {}; run: touchstone check",
                                 options.golden.out));
  for (const auto& p : pending) {
    const std::string what = golden::accept_result(p, options.golden.folder(), options.golden.out, options.reason);
    fmt::print("{} {} {}\n", what, p.case_name, p.model);
  }
  return ExitStatus::passed;
}

struct NewCaseOptions {
  GoldenOptions golden;
  golden::NewCase made;
  std::vector<std::string> models, set;
  golden::CaseLoop loop{"", "light", {}, 1};
};

ExitStatus new_case(const NewCaseOptions& options) {
  golden::NewCase wanted = options.made;
  wanted.models.assign(options.models.begin(), options.models.end());
  if (!options.loop.device.empty()) {
    wanted.loop = options.loop;
    wanted.loop->set = named_values("--set", options.set);
  } else if (!options.set.empty()) {
    throw UsageError("--set: of a device; give --device too");
  }
  // Into the repository's own folder, which need not be there yet; never beside the bundled cases.
  const std::filesystem::path folder = golden::own_golden_folder(options.golden.golden);
  const golden::ChangeModel change = options.golden.change_model();
  const golden::MadeCase made = golden::make_case(built_in_catalogues(), folder, wanted, change);
  const golden::CaseCheck how{options.golden.out, false, change, std::nullopt};
  fmt::print(
      "{}: made. Rounding alone changes the force by {:.2g} N at most, of {:.3g} N; the tolerance and its reason stand "
      "in "
      "case.json\n",
      made.golden.folder.string(), made.rounding_N, made.largest_N);
  if (made.largest_N == 0.0)
    fmt::print(
        "warning: no model gives any force on this path: does it touch the object? Of a recording on a rigid "
        "object take rendered.csv of touchstone evaluate, whose path goes into it\n");
  for (const auto& [model, ignored] : made.golden.models) {
    const golden::CheckResult result = check_case(built_in_catalogues(), made.golden, model, how);
    fmt::print(
        "  {}: {}\n", model,
        result.skipped.empty() ? fmt::format("its pictures and numbers: {}", result.left_in.string()) : result.skipped);
  }
  fmt::print(
      "look at them; then commit the case and accept what it gives:\n  git add {0} && git commit -m 'Golden case {1}'\n"
      "  touchstone golden accept {1} --golden {2} --out {3} --reason 'first'\n",
      made.golden.folder.string(), made.golden.name, folder.string(), options.golden.out);
  return ExitStatus::passed;
}

void add_new_case(CLI::App& golden_command, Run& run) {
  auto options = std::make_shared<NewCaseOptions>();
  auto* const command =
      golden_command.add_subcommand("new", "Make a golden case of a mesh, a path and models of your own");
  command->add_option("NAME", options->made.name, "The case's name: lower-case letters, digits and '-'")->required();
  command->add_option("--mesh", options->made.mesh, "The object: OBJ, OFF, PLY or STL, also .gz")->required();
  command->add_option("--mesh-unit", options->made.mesh_unit, "Unit of the mesh's coordinates")->capture_default_str();
  command
      ->add_option("--trajectory", options->made.trajectory,
                   "The path: a trajectory, or a recording whose positions are taken as they are (also live.csv of hil "
                   "render, rendered.csv of evaluate)")
      ->required();
  command->add_option("--from", options->made.from_s, "Take the path from this time [s] on");
  command->add_option("--to", options->made.to_s, "Up to this time [s]; 0: to its end");
  command->add_option("--model", options->models, "Model files (touchstone-model/1); may be given several times")
      ->required();
  command->add_option("--summary", options->made.summary, "One line on what the case shows");
  command->add_option("--device", options->loop.device,
                      "Close the loop: a hand that means to follow the path holds this device (`touchstone loop`)");
  command->add_option("--grip", options->loop.grip, "That hand")->capture_default_str();
  command->add_option("--set", options->set,
                      "A figure of device or hand in place of the published one, NAME=VALUE; may be repeated");
  options->golden.plugins.add_to(*command);
  command->add_option("--golden", options->golden.golden, "Folder of your golden cases")
      ->envname("TOUCHSTONE_GOLDEN")
      ->capture_default_str();
  command->add_option("--out", options->golden.out, "Folder for what it gives, to look at")
      ->envname("TOUCHSTONE_GOLDEN_OUT")
      ->capture_default_str();
  command->footer(
      "Writes golden/NAME with a tolerance that rounding on this path asks for, runs it, and says how to accept "
      "it.\nExamples:\n"
      "  touchstone golden new edge-of-plate --mesh plate.obj --mesh-unit mm --trajectory scan.csv --model model.json\n"
      "  touchstone golden new tap --mesh cup.stl --trajectory live/live.csv --from 1 --to 3 --model mine.json "
      "--plugin "
      "./libmine.so\n"
      "  touchstone golden new press --mesh cup.stl --trajectory press.csv --model model.json --device touch-x");
  command->callback([options, &run] { run = [options] { return new_case(*options); }; });
}

struct EditOptions {
  std::string golden = GoldenOptions{}.golden, name, reason;
  std::vector<std::string> limits;
};

void add_edit(CLI::App& golden_command, Run& run) {
  auto options = std::make_shared<EditOptions>();
  auto* const command = golden_command.add_subcommand("edit", "Change limits of a case's tolerance, with the reason");
  command->add_option("CASE", options->name, "The case")->required();
  command
      ->add_option(
          "--set", options->limits,
          "QUANTITY.LIMIT=VALUE, as in case.json: force.atol_N=2e-5; without VALUE the limit is taken out; may be "
          "given several times")
      ->required();
  command->add_option("--reason", options->reason, "Why; stands in the case")->required();
  command->add_option("--golden", options->golden, "Folder of your golden cases")
      ->envname("TOUCHSTONE_GOLDEN")
      ->capture_default_str();
  command->footer(
      "Limits of each quantity: `touchstone formats touchstone-tolerance/1`. Goldens stay as they are.\nExample:\n"
      "  touchstone golden edit plate-stroke --set force.atol_N=2e-5 --reason 'the solver stops at 10 uN'");
  command->callback([options, &run] {
    run = [options] {
      const auto folder = golden::own_golden_folder(options->golden) / options->name;
      for (const std::string& line : golden::edit_tolerance(folder, options->limits, options->reason))
        fmt::print("{}\n", line);
      fmt::print("{}: changed; see what it says now: touchstone check {}\n", (folder / "case.json").string(),
                 options->name);
      return ExitStatus::passed;
    };
  });
}

ExitStatus export_command(const GoldenCommandOptions& options) {
  const auto cases = options.golden.load();
  if (cases.size() != 1) throw UsageError("export: name one case");
  golden::export_case(synthetic::built_in_generators(), cases.front(), options.golden.models_of(cases.front()),
                      options.to);
  fmt::print("{}\n", std::filesystem::path(options.to).string());
  return ExitStatus::passed;
}

ExitStatus render(const GoldenCommandOptions& options) {
  const golden::ChangeModel change = options.golden.change_model();
  for (const golden::GoldenCase& golden : options.golden.load()) {
    for (const std::string& model : options.golden.models_of(golden)) {
      const golden::CaseRun done = run_case(built_in_catalogues(), golden, model, false, change);
      golden::write_golden(std::filesystem::path(options.to) / golden.name / (model + ".h5"), done.rendered,
                           done.provenance);
    }
  }
  return ExitStatus::passed;
}

}  // namespace

void add_golden(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "golden", "Make and edit golden cases, review and accept their results, measure their noise floor");
  command->require_subcommand(1);
  add_new_case(*command, run);
  add_edit(*command, run);
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
