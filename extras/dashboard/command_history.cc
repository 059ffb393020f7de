#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "dashboard_commands.h"
#include "harness/base/atomic_file.h"
#include "harness/report/ctest_measurement.h"
#include "harness/report/gnuplot.h"
#include "history_page.h"
#include "history_source.h"
#include "judged_history.h"

namespace touchstone::dashboard {

namespace {

struct HistoryOptions {
  HistorySource source;
  std::string plot, page, json, commit, collect, limits, worse = "any";
  HistoryLimit limit;
  std::vector<std::string> accepted;
  double value = 0.0;
  bool record = false;
  bool ctest = false;
};

// False if a measurement of the run that is collected is no number: then the newest value is missing, and what is
// judged in its place is an older one.
bool record_first(const HistoryOptions& options) {
  bool all_numbers = true;
  if (!options.record && options.collect.empty()) return all_numbers;
  if (options.source.local.size() != 1 || options.commit.empty())
    throw UsageError("--record and --collect need one --local FILE to write to, and --commit");
  if (!options.collect.empty()) {
    const CollectedRun run = collect_ctest(options.collect, options.commit);
    append_history(options.source.local[0], run.series);
    for (const std::string& text : run.not_numbers) fmt::print("not recorded: {}\n", text);
    all_numbers = run.not_numbers.empty();
  }
  if (options.record) {
    if (options.source.wanted.metric.empty()) throw UsageError("--record needs --metric");
    append_history(options.source.local[0], {{options.source.wanted, {{options.commit, "", options.value}}}});
  }
  return all_numbers;
}

void write_history_outputs(const HistoryOptions& options, const JudgedHistory& history) {
  if (!options.json.empty()) write_file(options.json, history_json(history.all).dump(1) + "\n");
  if (!options.page.empty()) write_file(options.page, history_page(history.all, "Metrics over builds"));
  const JudgedSeries* const picture = history.worst();
  if (picture == nullptr || picture->series.points.empty()) return;
  if (!options.plot.empty()) {
    if (const auto problem = report::write_plot(history_plot(*picture), options.plot); !problem.empty())
      throw BadData(fmt::format("{}: {}", options.plot, problem));
  }
}

void print_for_ctest(const HistoryOptions& options, const JudgedHistory& history) {
  fmt::print("{}", report::measurement("history_series", static_cast<double>(history.all.size())));
  fmt::print("{}", report::measurement("history_failed", static_cast<double>(history.failures())));
  const JudgedSeries* const picture = history.worst();
  if (picture == nullptr) return;
  const std::filesystem::path png = options.plot.empty() ? "history.png" : options.plot;
  const auto problem = report::write_plot(history_plot(*picture), png);
  if (problem.empty()) {
    fmt::print("{}", report::picture_measurement("TestImage", std::filesystem::absolute(png)));
  } else {
    fmt::print("no picture: {}\n", problem);
  }
}

ExitStatus history_command(HistoryOptions options) {
  // As a standing test: where there is nothing to read, the test is skipped with its reason.
  options.source = source_from_environment(options.source, options.ctest);
  if (!options.source.given()) {
    fmt::print(
        "skipped: no history is at hand: set TOUCHSTONE_HISTORY to a file or folder of JSON lines, or "
        "TOUCHSTONE_CDASH_URL\n");
    return ExitStatus::skipped;
  }
  if (options.worse == "up") options.limit.worse = Worse::up;
  if (options.worse == "down") options.limit.worse = Worse::down;
  for (const auto& commit : options.accepted) options.limit.accepted.push_back({commit, "by --accept"});
  const bool all_numbers = record_first(options);
  auto series = load_series(options.source);
  HistoryLimits limits;
  if (!options.limits.empty()) limits = load_history_limits(options.limits);
  limits.limits.insert(limits.limits.begin(), options.limits.empty() ? 1U : 0U, options.limit);
  const bool gated =
      options.limit.maximum || options.limit.minimum || options.limit.most_rise || options.limit.most_fall;
  if (series.empty() && (gated || !options.limits.empty())) series.push_back({options.source.wanted, {}});
  if (series.empty()) {
    fmt::print("{}: no values\n", options.source.wanted.metric.empty() ? "history" : options.source.wanted.metric);
    return options.collect.empty() ? ExitStatus::bad_data : all_numbers ? ExitStatus::passed : ExitStatus::failed;
  }
  const JudgedHistory history = judge_history(std::move(series), limits);
  fmt::print("{}", history.text());
  if (options.ctest) print_for_ctest(options, history);
  write_history_outputs(options, history);
  return history.failed() || !all_numbers ? ExitStatus::failed : ExitStatus::passed;
}

void add_series_selection(CLI::App& command, HistoryOptions& options) {
  command.add_option("--metric", options.source.wanted.metric,
                     "Measurement, for instance force_rms_N; a final * takes all that begin so; default all");
  command.add_option("--test", options.source.wanted.test, "Name of the test, the same way");
  command.add_option("--site", options.source.wanted.site, "Name of the machine, the same way");
  command.add_option("--build", options.source.wanted.build, "Name of the build, the same way");
  command.add_option("--track", options.source.wanted.track, "Nightly, Experimental, HIL, ...");
}

CLI::Option* add_history_sources(CLI::App& command, HistoryOptions& options) {
  command.add_option(
      "--local", options.source.local,
      "File with one JSON object to a line: commit, metric, value [, test, site, build, track, time]; or a "
      "folder of such *.jsonl files, for instance artefacts of a CI service");
  auto* const cdash = command
                          .add_option("--cdash", options.source.server.url,
                                      "A CDash server; without an address that of TOUCHSTONE_CDASH_URL. Token: "
                                      "TOUCHSTONE_CDASH_TOKEN or the file TOUCHSTONE_CDASH_TOKEN_FILE")
                          ->expected(0, 1);
  command.add_option("--project", options.source.server.project,
                     "The server's project; default TOUCHSTONE_CDASH_PROJECT, else Touchstone");
  command.add_option("--build-id", options.source.build_id,
                     "With --test and --metric: through the server's test graph of this build");
  command.add_option(
      "--collect", options.collect,
      "First add every measurement of the newest run in this folder (Testing of a build) to the local file");
  command.add_option("--commit", options.commit, "Of what is recorded or collected");
  return cdash;
}

void add_history_judgement(CLI::App& command, HistoryOptions& options) {
  command
      .add_option("--limits", options.limits,
                  "File of limits and accepted changes (touchstone-history/1), in place of the options below")
      ->check(CLI::ExistingFile);
  command.add_option("--max", options.limit.maximum, "Fail when the newest value is above this");
  command.add_option("--min", options.limit.minimum, "Fail when the newest value is below this");
  command.add_option("--max-rise", options.limit.most_rise,
                     "Fail when the newest value exceeds the median before by more than this fraction of its size");
  command.add_option("--max-fall", options.limit.most_fall, "The same below the median before");
  command.add_option("--worse", options.worse, "Which changes are for the worse")
      ->check(CLI::IsMember({"up", "down", "any"}))
      ->capture_default_str();
  command
      .add_option("--smallest-relative", options.limit.smallest_relative,
                  "Smaller changes do not matter: as a fraction of the level before")
      ->capture_default_str();
  command.add_option("--smallest-absolute", options.limit.smallest_absolute, "The same in the metric's unit")
      ->capture_default_str();
  command.add_option("--accept", options.accepted, "A change that came with this commit is meant");
}

}  // namespace

void add_history(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand("history", "Metrics over builds: limits, changes of level, drifts");
  auto options = std::make_shared<HistoryOptions>();
  add_series_selection(*command, *options);
  auto* const cdash = add_history_sources(*command, *options);
  add_history_judgement(*command, *options);
  auto* const value = command->add_option("--record", options->value, "First add this value to the local file");
  command->add_option("--plot", options->plot, "Write the worst series as PNG");
  command->add_option("--page", options->page, "Write every series as a page that opens offline (HTML)");
  command->add_option("--json", options->json, "Write values, changes and verdicts as JSON");
  command->add_flag("--ctest", options->ctest,
                    "As a standing test: measurements and a picture for CTest; sources from TOUCHSTONE_HISTORY or "
                    "TOUCHSTONE_CDASH_URL, skipped (77) without them");
  command->footer(
      "Series of different machines, build names, tracks, tests and metrics are judged each for itself. Exit status 1: "
      "a\n"
      "limit is broken, a change for the worse is neither accepted nor over, or a collected measurement is no number.\n"
      "Examples:\n"
      "  touchstone history --cdash https://cdash.example.org --test golden.sphere-scan.god-object --metric "
      "force_rms_N --track Nightly --max 0.01\n"
      "  touchstone history --local history.jsonl --metric operations --worse up --max-rise 0.02 --plot "
      "operations.png\n"
      "  touchstone history --local history.jsonl --collect build/default/Testing --commit $(git rev-parse HEAD) "
      "--page "
      "history.html");
  command->callback([options, cdash, value, &run] {
    options->source.cdash = cdash->count() > 0;
    options->record = value->count() > 0;
    run = [options] { return history_command(*options); };
  });
}

}  // namespace touchstone::dashboard
