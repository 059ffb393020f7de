#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <numeric>

#include "apps/commands.h"
#include "apps/sweep/engine.h"
#include "apps/sweep/slurm.h"
#include "harness/base/version.h"
#include "harness/baseline/golden_file.h"

namespace touchstone::apps {
namespace {

struct Options {
  std::string specification, out, shard, csv, engine = "local", slurm_options;
  std::vector<std::string> merge;
  unsigned threads = 0;
  std::uint64_t tasks = 0;
  unsigned attempts = 3;
  bool dry_run = false;
  bool retry_failed = false;
};

std::atomic<bool> stop_requested = false;

// What the file holds now against what it must hold.
ExitStatus conclude(const Options& options, const SweepDesign& design, const SweepStore& store, SweepShard shard) {
  const auto done = store.done();
  const std::uint64_t first = shard.first(design.size());
  const std::uint64_t last = shard.last(design.size());
  std::vector<std::uint64_t> missing;
  for (std::uint64_t number = first; number < last; ++number) {
    if (!std::ranges::binary_search(done, number)) missing.push_back(number);
  }
  const std::uint64_t failed = store.failed();
  if (!options.csv.empty()) store.write_csv(options.csv);
  fmt::print("{}: {} of {} cases, {} failed, content {}\n", options.out, last - first - missing.size(), last - first,
             failed, store.content_hash());
  constexpr std::size_t most_named = 10;
  if (!missing.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min(missing.size(), most_named); ++i) names += fmt::format(" {}", missing[i]);
    fmt::print("{} cases are missing:{}{}; run again to go on\n", missing.size(), names,
               missing.size() > most_named ? " ..." : "");
  }
  if (failed > 0) {
    fmt::print("why they failed: sqlite3 {} \"SELECT case_number, error FROM cases WHERE status = 'failed'\"\n",
               options.out);
  }
  return missing.empty() && failed == 0 ? ExitStatus::passed : ExitStatus::failed;
}

std::map<std::string, std::string> provenance() {
  auto known = build_provenance();
  std::string command;
  for (const std::string& word : command_line()) command += (command.empty() ? "" : " ") + word;
  known["command"] = command;
  return known;
}

ExitStatus run_here(const Options& options, const SweepDesign& design) {
  const SweepShard shard = read_shard(options.shard);
  SweepStore store(options.out, design);
  if (options.retry_failed) store.forget_failed();
  store.start_run(provenance());
  std::signal(SIGINT, [](int) { stop_requested = true; });
  std::signal(SIGTERM, [](int) { stop_requested = true; });
  const SweepTally tally = run_sweep(design, store, shard, options.threads, stop_requested);
  fmt::print(stderr, "{} cases ran, {} of them failed; {} were there already{}\n", tally.ran, tally.failed,
             tally.before, tally.stopped ? "; stopped, run again to go on" : "");
  return conclude(options, design, store, shard);
}

ExitStatus merge_parts(const Options& options, const SweepDesign& design) {
  SweepStore store(options.out, design);
  for (const std::string& part : options.merge) {
    const SweepMerge merged = store.merge(part);
    fmt::print(stderr, "{}: {} cases added, {} there already\n", part, merged.added, merged.repeated);
  }
  return conclude(options, design, store, {});
}

ExitStatus run_slurm(const Options& options, const SweepDesign& design) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  SlurmRequest request{self.parent_path() / "touchstone",
                       options.specification,
                       options.out,
                       std::min(design.size(), options.tasks == 0 ? design.size() / 100 + 1 : options.tasks),
                       std::max(1U, options.threads),
                       options.slurm_options};
  std::vector<std::uint64_t> open(request.shards);
  std::iota(open.begin(), open.end(), 1);
  if (options.dry_run) {
    fmt::print("{}", slurm_script(request, open));
    return ExitStatus::passed;
  }
  SweepStore store(options.out, design);
  for (unsigned attempt = 1; attempt <= options.attempts && !open.empty(); ++attempt) {
    fmt::print(stderr, "attempt {}: {} tasks of {} cores\n", attempt, open.size(), request.cores_per_task);
    if (!run_on_slurm(request, open)) fmt::print(stderr, "some tasks failed; their logs are beside their results\n");
    std::erase_if(open, [&](std::uint64_t index) {
      const auto part = shard_file(request, index);
      if (std::filesystem::exists(part)) store.merge(part);
      const SweepShard shard{index, request.shards};
      const auto done = store.done();
      const auto from = std::ranges::lower_bound(done, shard.first(design.size()));
      const auto to = std::ranges::lower_bound(done, shard.last(design.size()));
      return static_cast<std::uint64_t>(to - from) == shard.last(design.size()) - shard.first(design.size());
    });
  }
  return conclude(options, design, store, {});
}

ExitStatus sweep_command(const Options& options) {
  const SweepDesign design(options.specification);
  if (options.engine == "slurm") return run_slurm(options, design);
  if (!options.merge.empty()) return merge_parts(options, design);
  if (options.dry_run) {
    const SweepShard shard = read_shard(options.shard);
    for (std::uint64_t n = shard.first(design.size()); n < shard.last(design.size()); ++n)
      fmt::print("{}\t{}\n", n, design.at(n).document);
    return ExitStatus::passed;
  }
  return run_here(options, design);
}

}  // namespace

void add_sweep(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "sweep", "Run many cases: a grid, list or Latin hypercube of surfaces, motions and models");
  auto options = std::make_shared<Options>();
  command->add_option("SPEC", options->specification, "touchstone-sweep/1 (JSON); see docs/scaling.md")->required();
  command->add_option("--out", options->out, "Results (SQLite); a run that stopped goes on in it")
      ->default_str("SPEC with .sqlite");
  command->add_option("--threads", options->threads, "Default: all cores; with slurm the cores of a task, default 1");
  command->add_option("--shard", options->shard, "K/N: only the K-th of N parts of the cases");
  command->add_option("--merge", options->merge, "Put the results of shards together, and say what is missing");
  command->add_flag("--retry-failed", options->retry_failed, "Run cases again that failed");
  command->add_option("--csv", options->csv, "Write the rows as CSV, too");
  command->add_option("--engine", options->engine, "local, or slurm: a job array")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  command->add_option("--tasks", options->tasks, "slurm: tasks of the array; default one for 100 cases");
  command->add_option("--attempts", options->attempts, "slurm: how often lost tasks are sent")->capture_default_str();
  command->add_option("--slurm-options", options->slurm_options, "slurm: further #SBATCH options");
  command->add_flag("--dry-run", options->dry_run, "List the cases, or with slurm show the script; run nothing");
  command->footer(
      "A case that fails is a row with its error. Exit status 1: cases are missing, or failed.\n"
      "Examples:\n"
      "  touchstone sweep stiffness.json\n"
      "  touchstone sweep stiffness.json --shard 1/2 --out a.sqlite\n"
      "  touchstone sweep stiffness.json --merge a.sqlite b.sqlite --out all.sqlite --csv all.csv\n"
      "  touchstone sweep stiffness.json --engine slurm --tasks 200 --slurm-options=--partition=short --dry-run");
  command->callback([options, &run] {
    if (options->out.empty())
      options->out = std::filesystem::path(options->specification).replace_extension(".sqlite").string();
    run = [options] { return sweep_command(*options); };
  });
}

}  // namespace touchstone::apps
