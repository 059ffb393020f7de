#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/plugin_flags.h"
#include "apps/program.h"
#include "board_plan.h"
#include "board_sets.h"
#include "case_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/pipeline/board_json.h"
#include "harness/pipeline/board_site.h"
#include "harness/pipeline/verdict.h"
#include "harness/report/provenance.h"
#include "leaderboard_command.h"
#include "renderers/catalogue.h"
#include "signature.h"
#include "submission.h"

namespace touchstone::board {
using apps::command_line;
using apps::PluginFlags;
using metrics::TimeRanges;
using plugin::Plugins;
using runs::CaseCommand;

namespace {

struct LeaderboardOptions {
  std::vector<std::string> datasets, models, fit;
  std::string out = "touchstone-leaderboard", in_trajectory, tip = "point", fit_range = "all", score_range = "all",
              against, bundle, sign_key;
  std::vector<std::string> sources;
  bool no_reports = false;
  double level = 0.05;
  PluginFlags plugins;
  runs::CaseOptions cases;
};

BoardRequest board_request(const LeaderboardOptions& options, const Plugins& plugins) {
  BoardRequest request;
  request.plugins = &plugins;
  request.out = options.out;
  request.datasets.assign(options.datasets.begin(), options.datasets.end());
  if (request.datasets.empty()) request.datasets = board_sets(request.out / "datasets");
  for (const std::filesystem::path file : options.models)
    request.models.emplace_back(apps::load_model(file, plugins), file);
  request.base.command_line = command_line();
  request.base.time_ranges = TimeRanges::parse(options.score_range, "--score-range");
  if (const auto mode = recording::find_in_trajectory(options.in_trajectory)) {
    request.base.in_trajectory = *mode;
    request.in_trajectory_chosen = true;
  }
  request.tip = options.tip == "dataset" ? BoardTip::dataset : BoardTip::point;
  request.fit = options.fit;
  request.fit_range = TimeRanges::parse(options.fit_range, "--fit-range");
  request.reports = !options.no_reports;
  return request;
}

void write_board(const LeaderboardOptions& options, const pipeline::Board& board, const report::InputFile& rows) {
  const std::filesystem::path out = options.out;
  pipeline::SiteNotes notes;
  notes.provenance = report::make_provenance(command_line());
  notes.provenance.inputs.push_back(rows);
  notes.links = {{"leaderboard.json", "leaderboard.json"}, {"timings.json", "timings.json"}};
  if (!options.against.empty()) {
    notes.compared = true;
    notes.changes = pipeline::changes_since(pipeline::load_earlier(options.against), board);
    for (const std::string& line : notes.changes) fmt::print("changed: {}\n", line);
  }
  write_file(out / "leaderboard.json", pipeline::board_to_json(board));
  write_file(out / "timings.json", pipeline::timings_to_json(board));
  write_file(out / "index.html", pipeline::site_html(board, notes));
}

CaseCommand case_command_of(const BoardPlan& plan) {
  CaseCommand command;
  command.job = board_job(renderers::built_in_catalogue(), plan);
  command.table = board_table(plan);
  command.words = command_line();
  command.words.erase(command.words.begin());
  command.describe = [&plan](std::uint64_t number) {
    const BoardCell& cell = plan.cells[number];
    return fmt::format("{}: {}", plan.tasks[cell.task].name, cell.evaluation ? cell.evaluation->column : "floor");
  };
  return command;
}

std::vector<std::filesystem::path> libraries_of(const PluginFlags& flags) {
  return {flags.libraries.begin(), flags.libraries.end()};
}

std::vector<std::filesystem::path> paths_of(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

ExitStatus leaderboard_command(LeaderboardOptions options) {
  if (options.bundle.empty() && (!options.sign_key.empty() || !options.sources.empty()))
    throw UsageError("--sign-key and --source are about a submission: name its file with --bundle");
  ensure_writable_folder(options.out);
  const Plugins plugins = options.plugins.load();
  const BoardPlan plan = plan_board(renderers::built_in_catalogue(), board_request(options, plugins));
  const CaseCommand command = case_command_of(plan);
  if (options.cases.file.empty()) options.cases.file = (std::filesystem::path(options.out) / "rows.sqlite").string();
  const runs::CaseOutcome outcome = runs::run_case_command(command, options.cases);
  if (!outcome.store) return outcome.status;
  pipeline::Board board = board_of_rows(plan, *outcome.store);
  board.title = "Haptic renderers held against recordings";
  board.options.level = options.level;
  pipeline::rank_board(board, board.tasks.size() > 1);
  write_board(options, board, runs::stored_rows(*outcome.store, options.cases));
  if (!options.bundle.empty()) {
    write_file(options.bundle,
               submission_to_json(plan, board, libraries_of(options.plugins), paths_of(options.sources)));
    if (!options.sign_key.empty()) sign_submission(options.bundle, options.sign_key);
  }
  const std::size_t width = pipeline::terminal_width();
  for (const pipeline::Task& task : board.tasks) {
    fmt::print("{}\n{}\n\n{}\n", task.name, pipeline::wrapped(pipeline::verdict(task), width),
               pipeline::short_table(task));
  }
  if (board.overall)
    fmt::print("{}\n", pipeline::wrapped(pipeline::verdict(*board.overall, board.tasks.size()), width));
  fmt::print("site: {}\n", (std::filesystem::path(options.out) / "index.html").string());
  return outcome.status;
}

struct SubmissionOptions {
  std::string bundle, work = "touchstone-verify", signers;
  std::vector<std::string> datasets, sources;
  PluginFlags plugins;
};

// Who signed the bundle, if anybody did. Throws BadData for a signature that is not good, or that is missing though
// signers are given.
void print_signature(const SubmissionOptions& options) {
  const auto signature = signature_of(options.bundle);
  if (!std::filesystem::exists(signature) && options.signers.empty()) {
    fmt::print("not signed: nobody vouches for {}\n", options.bundle);
    return;
  }
  const CheckedSignature checked = check_signature(options.bundle, signature, options.signers);
  if (checked.signer.empty()) {
    fmt::print("signed with {}; --signers FILE says whose key may sign\n", checked.key);
  } else {
    fmt::print("signed by {} with {}\n", checked.signer, checked.key);
  }
}

ExitStatus leaderboard_verify(const SubmissionOptions& options) {
  ensure_writable_folder(options.work);
  const Plugins plugins = options.plugins.load();
  const Submission claimed = load_submission(options.bundle, plugins);
  print_signature(options);
  BoardRequest request;
  request.plugins = &plugins;
  request.out = options.work;
  request.datasets.assign(options.datasets.begin(), options.datasets.end());
  if (request.datasets.empty()) request.datasets = board_sets(request.out / "datasets");
  request.models = claimed.models;
  request.base.command_line = command_line();
  request.base.in_trajectory = claimed.in_trajectory;
  request.base.time_ranges = TimeRanges::parse(claimed.score_range, options.bundle + ": /score_range");
  request.in_trajectory_chosen = claimed.in_trajectory_chosen;
  request.tip = claimed.tip;
  request.fit = claimed.fit;
  request.fit_range = TimeRanges::parse(claimed.fit_range, options.bundle + ": /fit_range");
  request.reports = false;
  const BoardPlan plan = plan_board(renderers::built_in_catalogue(), request);
  const runs::CaseOutcome outcome = runs::run_case_command(case_command_of(plan), {});
  if (!outcome.store) return outcome.status;
  const pipeline::Board board = board_of_rows(plan, *outcome.store);
  for (const std::string& line :
       files_not_as_claimed(claimed, libraries_of(options.plugins), paths_of(options.sources)))
    fmt::print("note: {}\n", line);
  const auto lines = differences(claimed, plan, board);
  for (const std::string& line : lines) fmt::print("differs: {}\n", line);
  if (lines.empty()) fmt::print("the same numbers, to the last digit\n");
  return lines.empty() ? ExitStatus::passed : ExitStatus::failed;
}

void add_leaderboard_verify(CLI::App& leaderboard, apps::Run& run) {
  auto* const command =
      leaderboard.add_subcommand("verify", "Run what a submission claims again: the same numbers, or which differ");
  auto options = std::make_shared<SubmissionOptions>();
  command->add_option("BUNDLE", options->bundle, "What --bundle wrote")->required();
  command->add_option("--dataset", options->datasets,
                      "The data sets that it is about; not given: the bundled and the synthetic ones");
  command->add_option("--signers", options->signers,
                      "Allowed signers, as of ssh-keygen(1): refuse a bundle that none of them signed");
  command->add_option("--source", options->sources,
                      "A source file of a plug-in, as for --bundle; may be given several times");
  command->add_option("--work", options->work, "Folder for synthetic data sets")->capture_default_str();
  options->plugins.add_to(*command);
  command->footer(
      "A signature beside the bundle (BUNDLE.sig) is checked. A plug-in that was built anew is noted; what counts is\n"
      "whether it gives the same numbers.\n"
      "Exit status: 0 the same, 1 something differs, 3 no submission, one that was changed, or a wrong signature.\n"
      "Examples:\n  touchstone leaderboard verify submission.json --plugin ./libmine.so\n"
      "  touchstone leaderboard verify submission.json --signers allowed-signers --source mine.c --plugin "
      "./libmine.so");
  command->callback([options, &run] { run = [options] { return leaderboard_verify(*options); }; });
}

}  // namespace

void add_leaderboard(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "leaderboard", "Rank renderers over data sets, as far as the data can tell them apart; one site with everything");
  auto options = std::make_shared<LeaderboardOptions>();
  command->add_option("--dataset", options->datasets,
                      "Folder with dataset.json; may be given several times. Not given: the bundled and the synthetic "
                      "ones");
  command->add_option("--model", options->models,
                      "Model file of a renderer that enters; not given: every renderer that there is");
  command->add_option("--out", options->out, "Folder of index.html, leaderboard.json, timings.json and reports/")
      ->capture_default_str();
  command
      ->add_option("--in-trajectory", options->in_trajectory,
                   "synthesize, whole-force or measured, the same for all; not given: the data set's, and whole-force "
                   "where it declares friction")
      ->check(CLI::IsMember({"synthesize", "whole-force", "measured"}));
  command
      ->add_option("--tip", options->tip,
                   "point: every renderer gets the point where the probe touched; dataset: the probe's own tip, and "
                   "renderers of points do not enter where it is a ball")
      ->check(CLI::IsMember({"point", "dataset"}))
      ->capture_default_str();
  command->add_option("--fit", options->fit,
                      "Parameter that is fitted for every renderer that has it: mu_dynamic=0:1; may be given several "
                      "times");
  command->add_option("--fit-range", options->fit_range, "What the fit sees: even:6s")->capture_default_str();
  command->add_option("--score-range", options->score_range, "What the scores see: odd:6s")->capture_default_str();
  command->add_option("--against", options->against, "leaderboard.json of an earlier run: say what changed");
  command->add_option("--bundle", options->bundle,
                      "Also write a submission that anyone can check: touchstone leaderboard verify FILE");
  command->add_option("--sign-key", options->sign_key,
                      "Sign the bundle with this SSH key (ssh-keygen): writes the bundle's name with .sig");
  command->add_option("--source", options->sources,
                      "A source file of a plug-in, whose hash goes into the bundle; may be given several times");
  command->add_flag("--no-reports", options->no_reports, "Do not write a report for every renderer and data set");
  command->add_option("--level", options->level, "Chance of one false difference on a board that is accepted")
      ->check(CLI::Range(1e-4, 0.5))
      ->capture_default_str();
  options->plugins.add_to(*command);
  runs::add_case_flags(*command, options->cases, "entries");
  runs::add_case_file_flags(*command, options->cases, "rows.sqlite in the folder of --out");
  command->footer(
      "A run that stopped goes on where it was. A renderer that crashes or cannot take a data set is a row that says "
      "so.\n"
      "Examples:\n"
      "  touchstone leaderboard --out board\n"
      "  touchstone leaderboard --plugin ./libmine.so --dataset my-plate --dataset my-cup --out board\n"
      "  touchstone leaderboard --dataset soft --fit stiffness_N_per_m=50:5000 --fit-range even:6s --score-range "
      "odd:6s\n"
      "  touchstone leaderboard --out board --against last/leaderboard.json");
  add_leaderboard_verify(*command, run);
  command->callback([command, options, &run] {
    if (command->get_subcommands().empty()) run = [options] { return leaderboard_command(*options); };
  });
}

}  // namespace touchstone::board
