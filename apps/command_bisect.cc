#include <fmt/format.h>
#include <signal.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/hash.h"
#include "harness/base/other_program.h"
#include "harness/bisection/answer_report.h"
#include "harness/bisection/measured_table.h"
#include "harness/bisection/measures.h"
#include "harness/bisection/reference.h"

namespace touchstone::apps {
namespace {

namespace fs = std::filesystem;

constexpr const char* default_out = "touchstone-bisect";

struct BisectFlags {
  std::string good, bad, repository = ".", build, measure, golden_case, golden_folder, reference, model;
  std::string metric = "force_rms_N", program = "bin/touchstone", plugin, out = default_out, json;
  double least_share = 0.05;
  double least_change = 0.0;
  std::size_t runs = 25;
  std::size_t jobs = 1;
};

std::atomic<bool> bisect_stopped = false;

fs::path light_program() { return fs::read_symlink("/proc/self/exe").parent_path() / "touchstone"; }

// All that the measured numbers depend on besides the commits.
std::string question_of(const BisectFlags& flags, const std::optional<bisection::ReplayMeasure>& replay) {
  nlohmann::json question{{"build", flags.build}};
  if (!replay) {
    question["measure"] = flags.measure;
    return question.dump();
  }
  question["metric"] = flags.metric;
  question["model"] = replay->model;
  question["program"] = flags.plugin.empty() ? flags.program : "";
  question["plugin"] = flags.plugin;
  for (const auto& file : fs::directory_iterator(replay->reference)) {
    if (file.is_regular_file()) question["reference"][file.path().filename().string()] = sha256_file(file.path());
  }
  return question.dump();
}

bisection::ReplayMeasure replay_of(const BisectFlags& flags, const fs::path& out) {
  bisection::ReplayMeasure replay;
  replay.reference = flags.reference.empty() ? out / "reference" : fs::absolute(flags.reference);
  if (flags.reference.empty()) {
    bisection::export_reference({light_program(), flags.golden_case, flags.golden_folder}, replay.reference,
                                out / "export.txt", bisect_stopped);
  }
  replay.model = flags.model.empty() ? bisection::model_in(replay.reference) : flags.model;
  replay.metric = flags.metric;
  replay.program = flags.program;
  replay.plugin = flags.plugin;
  replay.self = light_program();
  replay.out = out;
  return replay;
}

class StopBisection {
 public:
  StopBisection() {
    struct sigaction stop {};
    stop.sa_handler = [](int) { bisect_stopped = true; };
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &stop, nullptr);
  }
};

ExitStatus bisect_command(const BisectFlags& flags) {
  const int sources =
      (flags.measure.empty() ? 0 : 1) + (flags.golden_case.empty() ? 0 : 1) + (flags.reference.empty() ? 0 : 1);
  if (sources != 1) throw UsageError("one of --case, --reference and --measure is needed; see --help");
  const bisection::GitHistory history(fs::absolute(flags.repository));
  bisection::BisectionRequest request;
  request.good = history.commit(flags.good, "--good");
  request.bad = history.commit(flags.bad, "--bad");
  if (request.good == request.bad || !history.is_ancestor(request.good, request.bad))
    throw UsageError(fmt::format("--good {}: is no ancestor of --bad {}", flags.good, flags.bad));
  request.out = fs::absolute(flags.out);
  ensure_writable_folder(request.out);
  if (flags.out == default_out) hide_from_git(request.out);
  const bisection::SearchLock lock(request.out);
  const StopBisection stoppable;
  request.metric = flags.measure.empty() ? flags.metric : "measure";
  request.build_command = flags.build.empty() ? bisection::own_build : flags.build;
  std::optional<bisection::ReplayMeasure> replay;
  if (flags.measure.empty()) replay = replay_of(flags, request.out);
  request.question = question_of(flags, replay);
  request.measure = replay ? bisection::replay_measure(*replay) : bisection::command_measure(flags.measure);
  request.search.least_share = flags.least_share;
  request.search.least_change = flags.least_change;
  request.search.most_runs = flags.runs;
  // Times are measured one after the other, and against the good end's program, which must be there.
  request.search.parallel = flags.metric == "time" ? 1 : flags.jobs;
  request.say = [](const std::string& text) { fmt::print(stderr, "bisect: {}\n", text); };
  try {
    const bisection::BisectionAnswer answer = bisection::bisect(history, request, bisect_stopped);
    const std::string json = bisection::answer_to_json(answer);
    write_file(request.out / "answer.json", json);
    if (!flags.json.empty()) write_file(flags.json, json);
    fmt::print("{}", bisection::answer_to_text(answer));
    for (const bisection::NamedStep& named : answer.steps) {
      const std::string where = replay ? bisection::where_it_differs(*replay, named.commits.back()) : "";
      if (!where.empty()) fmt::print("error of {}:\n{}", named.commits.back().substr(0, 10), where);
    }
    const auto problem = write_plot(bisection::answer_to_plot(answer), request.out / "curve.png");
    if (!problem.empty()) fmt::print(stderr, "bisect: no picture: {}\n", problem);
    fmt::print("kept: {} (answer.json, {}measured.jsonl, logs)\n", request.out.string(),
               problem.empty() ? "curve.png, " : "");
    return answer.steps.empty() && answer.drifts.empty() ? ExitStatus::failed : ExitStatus::passed;
  } catch (const Interrupted&) {
    throw BadData(fmt::format("interrupted; the checkout is as it was. The same command goes on from {}",
                              (request.out / "measured.jsonl").string()));
  }
}

}  // namespace

void add_bisect(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "bisect", "Which commits changed accuracy, cost or any number: every culprit with its share, and drift as drift");
  const auto flags = std::make_shared<BisectFlags>();
  command->add_option("--good", flags->good, "A commit before the change")->required();
  command->add_option("--bad", flags->bad, "A commit after it")->required();
  command->add_option("--repository", flags->repository, "The renderer's git repository")->capture_default_str();
  command->add_option("--build", flags->build,
                      "Command for sh that builds the sources in $SRC into $BUILD; default: Touchstone's own build");
  command->add_option("--measure", flags->measure,
                      "Command for sh whose last printed word is the number ($SRC, $BUILD, $WORK, $COMMIT are set); "
                      "exit status other than 0: this commit is skipped");
  command->add_option("--case", flags->golden_case, "Instead: replay this golden case");
  command->add_option("--golden", flags->golden_folder, "The folder of golden cases");
  command->add_option(
      "--reference", flags->reference,
      "Instead: replay mesh.obj, trajectory.csv and MODEL.json of this folder; compared with MODEL.h5 or "
      "MODEL.golden.csv, without either with what the good end renders");
  command->add_option("--model", flags->model, "The model, if the case or reference has several");
  command
      ->add_option("--metric", flags->metric,
                   "As `touchstone compare` names it (force_rms_N, contact_position_max_m, ...), operations, or time")
      ->capture_default_str();
  command->add_option("--program", flags->program, "The program in $BUILD that replays")->capture_default_str();
  command->add_option("--plugin", flags->plugin,
                      "The plug-in in $BUILD that this touchstone replays, instead of a program");
  command
      ->add_option("--least-share", flags->least_share, "Smallest culprit to look for, as a share of the whole change")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  command->add_option("--least-change", flags->least_change, "The same in the metric's unit")->capture_default_str();
  command->add_option("--runs", flags->runs, "Most runs of one commit, if the metric is noisy")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--jobs", flags->jobs, "Commits that are built at once, each in a worktree of its own")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--out", flags->out,
                   "Folder for the answer and what was measured; a search that was stopped goes on")
      ->capture_default_str();
  command->add_option("--json", flags->json, "Write the answer as JSON there, too");
  command->footer(
      "Commits that do not build or run are skipped; the checkout and its branches stay as they are.\n"
      "Exit status: 0 culprits or drift found, 1 the ends do not differ or nothing could be located, 2 usage, 3 an "
      "end\n"
      "cannot be measured.\n"
      "Examples:\n"
      "  touchstone bisect --case sphere-scan --model god-object --good HEAD~20 --bad HEAD\n"
      "  touchstone bisect --repository ~/mine --build 'cmake -S $SRC -B $BUILD && cmake --build $BUILD' "
      "--plugin libmine.so --reference ref --good v1 --bad main\n"
      "  touchstone bisect --measure '$BUILD/bench --print-rms' --build 'make -C $SRC O=$BUILD' --good v1 --bad main");
  command->callback([&run, flags] { run = [flags] { return bisect_command(*flags); }; });
}

}  // namespace touchstone::apps
