#include "case_command.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <numeric>

#include "farm.h"
#include "harness/base/atomic_file.h"
#include "harness/base/bundled_files.h"
#include "harness/base/hash.h"
#include "harness/base/progress.h"
#include "harness/golden/golden_file.h"
#include "slurm.h"

namespace touchstone::runs {
namespace {

std::atomic<bool> stop_requested = false;

// An interrupt stops the cases soon, within a case too where it asks (stop_if_asked), while this lives; what is done
// afterwards ends as it always does.
class StopWhenInterrupted {
 public:
  StopWhenInterrupted() {
    struct sigaction stop {};
    stop.sa_handler = [](int) {
      stop_requested = true;
      ask_to_stop();
    };
    ::sigaction(SIGINT, &stop, &interrupt_);
    ::sigaction(SIGTERM, &stop, &terminate_);
  }
  ~StopWhenInterrupted() {
    ::sigaction(SIGINT, &interrupt_, nullptr);
    ::sigaction(SIGTERM, &terminate_, nullptr);
    allow_work();
  }
  StopWhenInterrupted(const StopWhenInterrupted&) = delete;
  StopWhenInterrupted& operator=(const StopWhenInterrupted&) = delete;

 private:
  struct sigaction interrupt_ {};
  struct sigaction terminate_ {};
};

// What names a build. A changed checkout has no name: there it is the program itself.
const std::vector<std::string> build_names{"version", "commit", "dirty", "program", "compiler", "flags"};

std::map<std::string, std::string> provenance(const CaseOptions& options) {
  auto known = golden::build_provenance();
  known["command"] = options.called_as;
  if (known["dirty"] == "yes") known["program"] = sha256_file(own_program());
  return known;
}

std::string this_build(const CaseOptions& options) {
  const auto known = provenance(options);
  std::string text;
  for (const std::string& name : build_names)
    text += (text.empty() ? "" : ", ") + name + " " + (known.contains(name) ? known.at(name) : "");
  return text;
}

void check_builds(const CaseCommand& command, const CaseOptions& options, const CaseStore& store) {
  auto makers = store.makers(build_names);
  if (makers.empty()) return;
  const std::string own = this_build(options);
  makers.erase(own);
  if (makers.empty()) return;
  const std::string said =
      fmt::format("{}: some of its rows were made by another build of touchstone\n  {}\n  not by\n  {}", options.file,
                  *makers.begin(), own);
  if (command.one_build && !options.any_build) {
    throw BadData(said + fmt::format("\ngive another {}, or remove the file, or go on with --any-build",
                                     command.table.file_option));
  }
  fmt::print(stderr, "note: {}\n", said);
}

std::unique_ptr<CaseStore> open_store(const CaseCommand& command, const CaseOptions& options) {
  return std::make_unique<CaseStore>(options.file.empty() ? CaseStore::in_memory : options.file, command.table);
}

// What the file holds now against what it must hold.
CaseOutcome conclude(const CaseCommand& command, const CaseOptions& options, std::unique_ptr<CaseStore> store,
                     CaseShard shard) {
  const std::uint64_t first = shard.first(command.job.cases);
  const std::uint64_t last = shard.last(command.job.cases);
  const auto missing = cases_left(store->done(), first, last);
  const std::uint64_t failed = store->failed();
  if (!options.csv.empty()) store->write_csv(options.csv);
  if (!options.file.empty()) {
    fmt::print("{}: {} of {} cases, {} failed, content {}\n", options.file, last - first - missing.size(), last - first,
               failed, store->content_hash());
  }
  constexpr std::size_t most_named = 10;
  if (!missing.empty()) {
    std::string names;
    for (std::size_t i = 0; i < std::min(missing.size(), most_named); ++i) names += fmt::format(" {}", missing[i]);
    fmt::print("{} cases are missing:{}{}; run again to go on\n", missing.size(), names,
               missing.size() > most_named ? " ..." : "");
  }
  if (failed > 0 && !options.file.empty()) {
    fmt::print("why they failed: sqlite3 {} \"SELECT case_number, error FROM cases WHERE status = 'failed'\"\n",
               options.file);
  }
  CaseOutcome outcome;
  outcome.status = missing.empty() && failed == 0 ? ExitStatus::passed : ExitStatus::failed;
  if (missing.empty() && last - first == command.job.cases) outcome.store = std::move(store);
  return outcome;
}

CaseOutcome run_here(const CaseCommand& command, const CaseOptions& options) {
  const CaseShard shard = read_shard(options.shard);
  auto store = open_store(command, options);
  if (options.retry_failed) store->forget_failed();
  check_builds(command, options, *store);
  store->start_run(provenance(options));
  const CaseTally tally = [&] {
    const StopWhenInterrupted interruptible;
    return run_cases(command.job, *store, shard, options.threads, stop_requested);
  }();
  if (!options.file.empty() || tally.failed > 0 || tally.stopped) {
    fmt::print(stderr, "{} cases ran, {} of them failed; {} were there already{}\n", tally.ran, tally.failed,
               tally.before, tally.stopped ? "; stopped, run again to go on" : "");
  }
  return conclude(command, options, std::move(store), shard);
}

CaseOutcome merge_parts(const CaseCommand& command, const CaseOptions& options) {
  auto store = open_store(command, options);
  for (const std::string& part : options.merge) {
    const CaseMerge merged = store->merge(part, options.merge_tolerance);
    fmt::print(stderr, "{}: {} cases added, {} there already\n", part, merged.added, merged.repeated);
  }
  check_builds(command, options, *store);
  return conclude(command, options, std::move(store), {});
}

SlurmRequest shards_of(const CaseCommand& command, const CaseOptions& options) {
  if (options.file.empty())
    throw UsageError(fmt::format("--engine {}: {} is needed, in which the tasks' results are put together",
                                 options.engine, command.table.file_option));
  const std::filesystem::path self = own_program();
  const std::uint64_t cases = command.job.cases;
  SlurmRequest request;
  request.program = self.parent_path() / "touchstone";
  request.words = command.words;
  request.file_option = command.table.file_option;
  request.out = options.file;
  request.shards = std::min(cases, options.tasks == 0 ? cases / command.cases_of_a_task + 1 : options.tasks);
  request.cores_per_task = std::max(1U, options.threads);
  request.options = options.slurm_options;
  if (!options.farm.empty()) request.task = task_file(request).string();
  return request;
}

// Takes what the parts hold; the shards that are not whole stay in `open`.
void collect(CaseStore& store, const SlurmRequest& request, std::uint64_t cases, double tolerance,
             std::vector<std::uint64_t>& open) {
  for (const std::uint64_t index : open) {
    const auto part = shard_file(request, index);
    if (std::filesystem::exists(part)) store.merge(part, tolerance);
  }
  const auto done = store.done();
  std::erase_if(open, [&](std::uint64_t index) {
    const CaseShard shard{index, request.shards};
    return cases_left(done, shard.first(cases), shard.last(cases)).empty();
  });
}

// The files with which a farm runs what is open; called again, takes what it has done.
CaseOutcome plan_jobs(const CaseCommand& command, const CaseOptions& options) {
  SlurmRequest request = shards_of(command, options);
  const FarmDescription farm = options.farm.empty() ? FarmDescription{} : load_farm(options.farm);
  std::vector<std::uint64_t> open(request.shards);
  std::iota(open.begin(), open.end(), 1);
  const auto folder = task_file(request).parent_path();
  if (options.dry_run) {
    for (const FarmFile& file : farm_files(request, farm, open, options.attempts))
      fmt::print("== {}\n{}", file.name, file.text);
    return {};
  }
  auto store = open_store(command, options);
  check_builds(command, options, *store);
  collect(*store, request, command.job.cases, options.merge_tolerance, open);
  check_builds(command, options, *store);
  if (open.empty()) return conclude(command, options, std::move(store), {});
  ensure_writable_folder(folder);
  for (const FarmFile& file : farm_files(request, farm, open, options.attempts))
    write_file(folder / file.name, file.text);
  fmt::print("{} of {} shards are open: {}/shards.txt. Run them, then this command again:\n{}", open.size(),
             request.shards, folder.string(), farm_commands(request, farm, options.attempts));
  CaseOutcome outcome;
  outcome.status = ExitStatus::failed;
  return outcome;
}

CaseOutcome run_slurm(const CaseCommand& command, const CaseOptions& options) {
  const SlurmRequest request = shards_of(command, options);
  const std::uint64_t cases = command.job.cases;
  std::vector<std::uint64_t> open(request.shards);
  std::iota(open.begin(), open.end(), 1);
  const std::uint64_t max_array_size = slurm_max_array_size();
  if (options.dry_run) {
    for (const SlurmArray& array : slurm_arrays(open, max_array_size)) fmt::print("{}", slurm_script(request, array));
    return {};
  }
  if (!options.farm.empty()) {
    ensure_writable_folder(task_file(request).parent_path());
    write_file(task_file(request), task_script(request, load_farm(options.farm)));
  }
  auto store = open_store(command, options);
  check_builds(command, options, *store);
  for (unsigned attempt = 1; attempt <= options.attempts && !open.empty(); ++attempt) {
    fmt::print(stderr, "attempt {}: {} tasks of {} cores\n", attempt, open.size(), request.cores_per_task);
    const SlurmEnd end = run_on_slurm(request, slurm_arrays(open, max_array_size));
    if (end == SlurmEnd::some_failed) fmt::print(stderr, "some tasks failed; their logs are beside their results\n");
    collect(*store, request, cases, options.merge_tolerance, open);
    if (end == SlurmEnd::refused) {
      fmt::print(stderr, "sbatch refused the job for the reason above; sending it again would not help\n");
      break;
    }
  }
  check_builds(command, options, *store);
  return conclude(command, options, std::move(store), {});
}

}  // namespace

CaseOutcome run_case_command(const CaseCommand& command, const CaseOptions& options) {
  if (options.engine == "slurm") return run_slurm(command, options);
  if (options.engine == "jobs") return plan_jobs(command, options);
  if (!options.merge.empty()) return merge_parts(command, options);
  if (options.dry_run) {
    const CaseShard shard = read_shard(options.shard);
    for (std::uint64_t n = shard.first(command.job.cases); n < shard.last(command.job.cases); ++n)
      fmt::print("{}\t{}\n", n, command.describe(n));
    return {};
  }
  return run_here(command, options);
}

}  // namespace touchstone::runs
