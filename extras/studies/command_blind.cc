#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "blind/blind_cases.h"
#include "blind/blind_follow.h"
#include "blind/blind_score.h"
#include "blind/blind_table.h"
#include "case_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/bundled_files.h"
#include "harness/base/hash.h"
#include "harness/base/json_reader.h"
#include "harness/base/progress.h"
#include "harness/pipeline/discrepancy/workflow.h"
#include "hidden_physics/weaken.h"
#include "hidden_physics/write_case.h"
#include "renderers/catalogue.h"
#include "study_commands.h"

namespace touchstone::studies {
namespace {

struct BlindOptions {
  std::uint64_t seed = 1;
  double share = 1.0;
  double strength = 1.0;
  std::vector<std::string> sets;
  std::size_t count = 0;
  std::size_t first = 0;
  std::filesystem::path out;
  std::filesystem::path cases;
  std::filesystem::path answers;
  std::filesystem::path results;
  std::filesystem::path json;
  std::string id;
  runs::CaseOptions rows;
  std::filesystem::path trajectory;
  std::filesystem::path again;
};

bool hides_effects_to_be_found(const std::vector<std::string>& names) {
  const std::set<std::string> hiding{"one", "one-noisy", "two", "three", "unknown"};
  return !names.empty() &&
         std::all_of(names.begin(), names.end(), [&](const auto& name) { return hiding.contains(name); });
}

ExitStatus make(const BlindOptions& options) {
  if (options.share <= 0.0 || options.share > 1.0) throw UsageError("--share: above 0 and at most 1 was expected");
  for (const std::string& set : options.sets) {
    if (!blind::blind_full_count().contains(set)) {
      throw UsageError(
          fmt::format("--set {}: unknown; one, one-noisy, two, three, none, unknown, cannot-tell, "
                      "corrupted, full-band or outside was expected",
                      set));
    }
  }
  if (!(options.strength > 0.0) || options.strength > 1.0) {
    throw UsageError("--strength: above 0 and at most 1 was expected");
  }
  if (options.strength < 1.0 && !hides_effects_to_be_found(options.sets)) {
    throw UsageError(
        "--strength: with --set one, one-noisy, two, three or unknown alone; the others hide no effect to be found");
  }
  std::vector<hidden_physics::BlindCase> plans;
  for (const std::string& set : hidden_physics::blind_sets()) {
    if (!options.sets.empty() && std::find(options.sets.begin(), options.sets.end(), set) == options.sets.end())
      continue;
    const auto shared =
        static_cast<std::size_t>(std::ceil(options.share * static_cast<double>(blind::blind_full_count().at(set))));
    const std::size_t count = options.count > 0 ? options.count : shared;
    for (std::size_t i = 0; i < count; ++i) {
      plans.push_back(hidden_physics::plan_case(set, options.first + i, options.seed));
      if (options.strength < 1.0) hidden_physics::weaken(plans.back(), options.strength);
    }
  }
  // In the order of their opaque names, so that the order tells nothing.
  std::sort(plans.begin(), plans.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  const std::string answers = hidden_physics::answers_to_json(plans, options.seed);
  fmt::print("answers: {} cases, SHA-256 {}\n", plans.size(), sha256(answers));
  ensure_writable_folder(options.out / "cases");
  Progress progress("blind cases", plans.size());
  for (std::size_t i = 0; i < plans.size(); ++i) {
    hidden_physics::write_case(plans[i], options.out / "cases");
    progress.update(i + 1);
  }
  write_file(options.out / "answers.json", answers);
  fmt::print("cases: {}\nanswers, not for whoever searches: {}\n", (options.out / "cases").string(),
             (options.out / "answers.json").string());
  return ExitStatus::passed;
}

ExitStatus follow(const BlindOptions& options) {
  if (options.id.empty()) {
    if (options.cases.empty() || options.results.empty()) {
      throw UsageError("follow: --case and --trajectory for one case, or --cases and --results for all, are needed");
    }
    const std::size_t count = blind::follow_proposals(options.answers, options.cases, options.results, options.out);
    fmt::print("{}: {} cases along the motions asked for\n", options.out.string(), count);
    return ExitStatus::passed;
  }
  ensure_writable_folder(options.out);
  blind::record_along_proposal(options.answers, options.id, options.trajectory, options.out);
  fmt::print("{}: train.csv and holdout.csv along {}\n", options.out.string(), options.trajectory.string());
  return ExitStatus::passed;
}

void search_case(const std::filesystem::path& folder, const std::filesystem::path& out) {
  const auto start = std::chrono::steady_clock::now();
  pipeline::DiscrepancyFiles files;
  files.model = folder / "model.json";
  files.mesh = folder / "mesh.obj";
  files.recording = folder / "train.csv";
  files.holdout = folder / "holdout.csv";
  files.instrument = folder / "instrument.json";
  files.out = out;
  files.command_line = apps::command_line();
  files.program = own_program();
  const pipeline::DiscrepancyAnswer answer =
      run_discrepancy(renderers::built_in_catalogue(), files, [](const std::string&) {});
  std::string names;
  for (const std::string& effect : answer.effects) names += " " + effect;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{} {}{} ({:.0f} s)\n", folder.filename().string(), to_string(answer.verdict), names, seconds);
}

ExitStatus run_cases(BlindOptions options) {
  const auto folders = blind::blind_case_folders(options.cases);
  if (options.rows.file.empty()) {
    // Shards that run side by side have a file each.
    std::string name = options.rows.shard.empty() ? "rows" : "rows-" + options.rows.shard;
    std::ranges::replace(name, '/', '-');
    options.rows.file = (options.out / (name + ".sqlite")).string();
  }
  if (!options.rows.dry_run) ensure_writable_folder(options.out);
  runs::CaseCommand command;
  command.job = blind::blind_job(folders, options.out, search_case);
  command.table = blind::blind_case_table(folders);
  command.words = {"blind",   "run",
                   "--cases", std::filesystem::absolute(options.cases).string(),
                   "--out",   std::filesystem::absolute(options.out).string()};
  command.cases_of_a_task = 10;
  command.describe = [&](std::uint64_t number) { return folders[number].filename().string(); };
  const runs::CaseOutcome outcome = run_case_command(command, options.rows);
  if (outcome.store) blind::write_findings(folders, *outcome.store, options.out);
  return outcome.status;
}

ExitStatus score(const BlindOptions& options) {
  const auto scores = blind::score_blind(options.answers, options.cases, options.results, options.again);
  if (!options.json.empty()) write_file(options.json, blind::blind_json(scores));
  const blind::BlindTable table = blind::blind_table(scores);
  fmt::print("{}", table.text);
  const std::size_t made = load_json(options.answers).at("cases").size();
  if (scores.size() < made)
    fmt::print("{} of {} cases have no findings and are in no line of this table: no bar counts as met\n",
               made - scores.size(), made);
  return table.met && scores.size() == made ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_blind(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "blind", "Test the search for missing effects on recordings whose hidden cause it does not know");
  command->require_subcommand(1);
  const auto options = std::make_shared<BlindOptions>();

  auto* const maker = command->add_subcommand("make", "Write cases with opaque names and their answers apart");
  maker->add_option("--seed", options->seed, "of everything")->capture_default_str();
  maker->add_option("--share", options->share, "of the full test's 820 cases")->capture_default_str();
  maker->add_option("--set", options->sets,
                    "only these: one, one-noisy, two, three, none, unknown, cannot-tell, corrupted, full-band, "
                    "outside");
  maker->add_option("--count", options->count, "of each set, instead of the share");
  maker
      ->add_option("--strength", options->strength,
                   "of the hidden effects, of what they are otherwise: how weak is still found?")
      ->capture_default_str();
  maker->add_option("--first", options->first, "number of the first case in each set")->capture_default_str();
  maker->add_option("--out", options->out, "folder: cases/ and answers.json")->required();
  maker->callback([options, &run] { run = [options] { return make(*options); }; });

  auto* const runner = command->add_subcommand("run", "Search every case; cases that have findings are passed over");
  runner->add_option("--cases", options->cases, "folder of cases")->required();
  runner->add_option("--out", options->out, "folder for one folder of findings per case")->required();
  runner->add_option("--rows", options->rows.file, "Results (SQLite); a run that stopped goes on in it")
      ->default_str("rows.sqlite in --out, with a shard's name in it");
  runner->add_flag("--any-build", options->rows.any_build, "Go on with rows that another build of touchstone made");
  runs::add_case_flags(*runner, options->rows, "cases");
  runner->footer(
      "A row holds findings.json and next.csv, so that parts from other machines are put together by --merge.\n"
      "Exit status 1: cases are missing, or could not be searched.\n"
      "Examples:\n"
      "  touchstone blind run --cases blind/cases --out blind/found\n"
      "  touchstone blind run --cases blind/cases --out blind/found --shard 1/2   (and 2/2 beside it)\n"
      "  touchstone blind run --cases blind/cases --out blind/found --merge blind/found/rows-1-2.sqlite "
      "blind/found/rows-2-2.sqlite\n"
      "  touchstone blind run --cases blind/cases --out blind/found --engine jobs --tasks 80 --farm farm.json");
  runner->callback([options, &run] { run = [options] { return run_cases(*options); }; });

  auto* const follower =
      command->add_subcommand("follow", "Record a case's object along a motion that a search asked for");
  follower->add_option("--answers", options->answers, "answers.json")->required();
  follower->add_option("--case", options->id, "the case's opaque name; without it, all that asked");
  follower->add_option("--trajectory", options->trajectory, "next.csv of its findings");
  follower->add_option("--cases", options->cases, "for all: folder of cases");
  follower->add_option("--results", options->results, "for all: folder that blind run wrote");
  follower->add_option("--out", options->out, "folder for train.csv and holdout.csv; for all, of a folder each")
      ->required();
  follower->callback([options, &run] { run = [options] { return follow(*options); }; });

  auto* const scorer = command->add_subcommand("score", "Compare findings with the answers");
  scorer->add_option("--answers", options->answers, "answers.json")->required();
  scorer->add_option("--cases", options->cases, "folder of cases")->required();
  scorer->add_option("--results", options->results, "folder that blind run wrote")->required();
  scorer->add_option("--again", options->again, "results on the motions that cases asked for (see follow)");
  scorer->add_option("--json", options->json, "write the scores here too");
  scorer->callback([options, &run] { run = [options] { return score(*options); }; });

  command->footer(
      "Examples:\n"
      "  touchstone blind make --seed 7 --share 0.05 --out blind\n"
      "  touchstone blind make --seed 7 --set one --count 21 --strength 0.2 --out weak\n"
      "  touchstone blind run --cases blind/cases --out blind/found\n"
      "  touchstone blind run --cases blind/cases --out blind/found --shard 1/2   (and 2/2 beside it)\n"
      "  touchstone blind score --answers blind/answers.json --cases blind/cases --results blind/found\n"
      "  touchstone blind follow --answers blind/answers.json --case 3k7vq9xd --trajectory "
      "blind/found/3k7vq9xd/next.csv \\\n"
      "      --out again\n"
      "  touchstone blind follow --answers blind/answers.json --cases blind/cases --results blind/found --out "
      "blind/again/cases\n"
      "score exits with 1 where a bar is not met.");
}

}  // namespace touchstone::studies
