#include <fmt/format.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/report/cdash_history.h"
#include "harness/report/ctest_measurement.h"
#include "harness/report/gnuplot.h"
#include "harness/report/history_page.h"

namespace touchstone::apps {
namespace {

struct HistoryOptions {
  std::vector<std::string> local;
  CdashServer server;
  bool cdash = false;
  SeriesKey wanted;
  std::string build_id, plot, page, json, commit, collect, limits, worse = "any";
  HistoryLimit limit;
  std::vector<std::string> accepted;
  double value = 0.0;
  bool record = false;
  bool ctest = false;
};

std::vector<std::filesystem::path> history_files(const HistoryOptions& options) {
  return {options.local.begin(), options.local.end()};
}

// As a standing test: where there is nothing to read, the test is skipped with its reason.
std::string why_history_skipped(const HistoryOptions& options) {
  if (!options.ctest || options.cdash || !options.local.empty()) return "";
  return "no history is at hand: set TOUCHSTONE_HISTORY to a file or folder of JSON lines, or TOUCHSTONE_CDASH_URL";
}

HistoryOptions history_with_environment(HistoryOptions options) {
  if (options.ctest && options.local.empty() && !options.cdash) {
    const char* const local = std::getenv("TOUCHSTONE_HISTORY");
    if (local != nullptr && *local != '\0') options.local.emplace_back(local);
    options.cdash = options.local.empty() && !cdash_from_environment(options.server).url.empty();
  }
  if (!options.local.empty() == options.cdash && why_history_skipped(options).empty())
    throw UsageError("give either --local FILE or --cdash [URL]");
  if (options.cdash) {
    options.server = cdash_from_environment(options.server);
    if (options.server.url.empty()) throw UsageError("--cdash needs the address of a server, or TOUCHSTONE_CDASH_URL");
  }
  if (options.worse == "up") options.limit.worse = Worse::up;
  if (options.worse == "down") options.limit.worse = Worse::down;
  for (const auto& commit : options.accepted) options.limit.accepted.push_back({commit, "by --accept"});
  return options;
}

void record_first(const HistoryOptions& options) {
  if (!options.record && options.collect.empty()) return;
  if (options.local.size() != 1 || options.commit.empty())
    throw UsageError("--record and --collect need one --local FILE to write to, and --commit");
  if (!options.collect.empty()) append_history(options.local[0], collect_ctest(options.collect, options.commit));
  if (options.record) {
    if (options.wanted.metric.empty()) throw UsageError("--record needs --metric");
    append_history(options.local[0], {{options.wanted, {{options.commit, "", options.value}}}});
  }
}

std::vector<HistorySeries> history_series(const HistoryOptions& options) {
  if (!options.cdash) return load_history(history_files(options), options.wanted);
  CdashConnection connection(options.server);
  if (options.build_id.empty()) return cdash_history(connection, options.wanted);
  if (options.wanted.test.empty() || options.wanted.metric.empty())
    throw UsageError("--build-id needs --test and --metric");
  return {cdash_test_graph(connection, options.build_id, options.wanted.test, options.wanted.metric)};
}

void print_series(const JudgedSeries& judged, bool values) {
  fmt::print("{}\n", title_of(judged.series.key));
  std::vector<std::string> notes(judged.series.points.size());
  for (const auto& finding : judged.verdict.findings) {
    if (finding.change) notes[judged.verdict.report.changes[*finding.change].index] += "   " + finding.sentence;
  }
  for (std::size_t i = 0; i < judged.series.points.size() && values; ++i)
    fmt::print("  {:<24} {:>14.8g}{}\n", judged.series.points[i].commit, judged.series.points[i].value, notes[i]);
  for (const auto& finding : judged.verdict.findings)
    fmt::print("  {}: {}\n", finding.fails ? finding.change ? "change" : "gate" : "note", finding.sentence);
  std::size_t steps = 0;
  for (const auto& change : judged.verdict.report.changes) steps += change.kind == stats::ChangeKind::step ? 1 : 0;
  fmt::print("  {} values, {} steps, {} drifts: {}\n", judged.series.points.size(), steps,
             judged.verdict.report.changes.size() - steps, judged.verdict.failed() ? "FAILED" : "passed");
}

// The worst series first: those that failed, then the longest.
const JudgedSeries* worst_series(const std::vector<JudgedSeries>& all) {
  const JudgedSeries* best = nullptr;
  for (const auto& judged : all) {
    const auto rank = [](const JudgedSeries& j) { return std::pair(j.verdict.failed(), j.series.points.size()); };
    if (best == nullptr || rank(judged) > rank(*best)) best = &judged;
  }
  return best;
}

void write_history_outputs(const HistoryOptions& options, const std::vector<JudgedSeries>& all) {
  if (!options.json.empty()) write_file(options.json, history_json(all).dump(1) + "\n");
  if (!options.page.empty()) write_file(options.page, history_page(all, "Metrics over builds"));
  const JudgedSeries* const picture = worst_series(all);
  if (picture == nullptr || picture->series.points.empty()) return;
  if (!options.plot.empty()) {
    if (const auto problem = write_plot(history_plot(*picture), options.plot); !problem.empty())
      throw BadData(fmt::format("{}: {}", options.plot, problem));
  }
}

void print_for_ctest(const HistoryOptions& options, const std::vector<JudgedSeries>& all) {
  std::size_t failed = 0;
  for (const auto& judged : all) failed += judged.verdict.failed() ? 1 : 0;
  print_measurement(stdout, "history_series", static_cast<double>(all.size()));
  print_measurement(stdout, "history_failed", static_cast<double>(failed));
  const JudgedSeries* const picture = worst_series(all);
  if (picture == nullptr) return;
  const std::filesystem::path png = options.plot.empty() ? "history.png" : options.plot;
  const auto problem = write_plot(history_plot(*picture), png);
  if (problem.empty()) {
    print_picture(stdout, "TestImage", std::filesystem::absolute(png));
  } else {
    fmt::print("no picture: {}\n", problem);
  }
}

ExitStatus history_command(const HistoryOptions& given) {
  const HistoryOptions options = history_with_environment(given);
  if (const auto reason = why_history_skipped(options); !reason.empty()) {
    fmt::print("skipped: {}\n", reason);
    return ExitStatus::skipped;
  }
  record_first(options);
  auto series = history_series(options);
  HistoryLimits limits;
  if (!options.limits.empty()) limits = load_history_limits(options.limits);
  limits.limits.insert(limits.limits.begin(), options.limits.empty() ? 1U : 0U, options.limit);
  const bool gated =
      options.limit.maximum || options.limit.minimum || options.limit.most_rise || options.limit.most_fall;
  if (series.empty() && (gated || !options.limits.empty())) series.push_back({options.wanted, {}});
  if (series.empty()) {
    fmt::print("{}: no values\n", options.wanted.metric.empty() ? "history" : options.wanted.metric);
    return options.collect.empty() ? ExitStatus::bad_data : ExitStatus::passed;
  }
  std::vector<JudgedSeries> all;
  bool failed = false;
  for (auto& one : series) {
    auto verdict = judge_series(one, limits.of(one.key), limits.false_alarms_per_year, series.size());
    if (one.points.empty()) verdict.findings.push_back({"there is no value to judge", true, std::nullopt});
    failed = failed || verdict.failed();
    all.push_back({std::move(one), std::move(verdict)});
  }
  // One series is printed whole; of many, those with something to say.
  for (const auto& judged : all) {
    if (all.size() == 1 || !judged.verdict.findings.empty()) print_series(judged, all.size() == 1);
  }
  fmt::print("{} series; false alarms: at most {:.3g} % per year of daily builds, of all together\n", all.size(),
             100.0 * limits.false_alarms_per_year);
  if (options.ctest) {
    print_for_ctest(options, all);
  }
  write_history_outputs(options, all);
  return failed ? ExitStatus::failed : ExitStatus::passed;
}

void add_series_selection(CLI::App& command, HistoryOptions& options) {
  command.add_option("--metric", options.wanted.metric,
                     "Measurement, for instance force_rms_N; a final * takes all that begin so; default all");
  command.add_option("--test", options.wanted.test, "Name of the test, the same way");
  command.add_option("--site", options.wanted.site, "Name of the machine, the same way");
  command.add_option("--build", options.wanted.build, "Name of the build, the same way");
  command.add_option("--track", options.wanted.track, "Nightly, Experimental, HIL, ...");
}

CLI::Option* add_history_sources(CLI::App& command, HistoryOptions& options) {
  command.add_option(
      "--local", options.local,
      "File with one JSON object to a line: commit, metric, value [, test, site, build, track, time]; or a "
      "folder of such *.jsonl files, for instance artefacts of a CI service");
  auto* const cdash = command
                          .add_option("--cdash", options.server.url,
                                      "A CDash server; without an address that of TOUCHSTONE_CDASH_URL. Token: "
                                      "TOUCHSTONE_CDASH_TOKEN or the file TOUCHSTONE_CDASH_TOKEN_FILE")
                          ->expected(0, 1);
  command.add_option("--project", options.server.project,
                     "The server's project; default TOUCHSTONE_CDASH_PROJECT, else Touchstone");
  command.add_option("--build-id", options.build_id,
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

void add_history(CLI::App& program, Run& run) {
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
      "HistorySeries of different machines, build names, tracks, tests and metrics are judged each for itself. Exit "
      "status 1: "
      "a\n"
      "limit is broken, or a change for the worse is neither accepted nor over.\n"
      "Examples:\n"
      "  touchstone history --cdash https://cdash.example.org --test golden.sphere-scan.god-object --metric "
      "force_rms_N --track Nightly --max 0.01\n"
      "  touchstone history --local history.jsonl --metric operations --worse up --max-rise 0.02 --plot "
      "operations.png\n"
      "  touchstone history --local history.jsonl --collect build/default/Testing --commit $(git rev-parse HEAD) "
      "--page "
      "history.html");
  command->callback([options, cdash, value, &run] {
    options->cdash = cdash->count() > 0;
    options->record = value->count() > 0;
    run = [options] { return history_command(*options); };
  });
}

}  // namespace touchstone::apps
