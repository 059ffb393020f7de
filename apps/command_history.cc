#include <fmt/format.h>

#include <cstdlib>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/report/cdash_history.h"
#include "harness/report/gnuplot.h"

namespace touchstone::apps {
namespace {

struct HistoryOptions {
  std::string local, cdash, project = "Touchstone", test, build_id, test_id, metric, plot, json, commit;
  HistoryGate gate;
  double value = 0.0;
  bool record = false;
};

History read(const HistoryOptions& options) {
  if (!options.local.empty()) return load_history(options.local, options.metric, options.test);
  const char* const token = std::getenv("TOUCHSTONE_CDASH_TOKEN");
  const CdashServer server{options.cdash, token == nullptr ? "" : token};
  if (!options.build_id.empty()) return cdash_test_graph(server, options.build_id, options.test_id, options.metric);
  return cdash_history(server, options.project, options.test, options.metric);
}

std::string draw(const HistoryOptions& options, const History& history, const std::vector<Step>& steps) {
  PlotPanel panel{options.metric, options.metric, {{"measured", {}, true}, {"level", {}, false}}, {0.0, 0.0}};
  std::size_t next = 0;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const auto x = static_cast<double>(i + 1);
    panel.lines[0].points.emplace_back(x, history[i].value);
    if (next < steps.size() && steps[next].index == i) {
      panel.lines[1].points.emplace_back(x - 0.5, steps[next].before);
      panel.lines[1].points.emplace_back(x - 0.5, steps[next].after);
      ++next;
    }
  }
  if (panel.lines[1].points.empty()) panel.lines.pop_back();
  return write_plot({options.test.empty() ? options.metric : options.test, "commit, oldest first", {panel}},
                    options.plot);
}

ExitStatus history_command(const HistoryOptions& options) {
  if (options.local.empty() == options.cdash.empty()) throw UsageError("give either --local FILE or --cdash URL");
  if (options.record) {
    if (options.local.empty() || options.commit.empty()) throw UsageError("--record needs --local and --commit");
    append_history(options.local, {options.commit, "", options.value}, options.metric, options.test);
  }
  const History history = read(options);
  std::vector<double> values;
  values.reserve(history.size());
  for (const auto& point : history) values.push_back(point.value);
  const auto steps = find_steps(values);
  std::size_t next = 0;
  for (std::size_t i = 0; i < history.size(); ++i) {
    fmt::print("{:<24} {:>14.8g}", history[i].commit, history[i].value);
    if (next < steps.size() && steps[next].index == i) {
      fmt::print("   step: {:.6g} -> {:.6g} ({:.1f} standard errors)", steps[next].before, steps[next].after,
                 steps[next].score);
      ++next;
    }
    fmt::print("\n");
  }
  fmt::print("{}: {} values, {} steps\n", options.metric, history.size(), steps.size());
  if (!options.json.empty()) {
    std::string found;
    for (const Step& step : steps) {
      found += fmt::format("{}{{\"index\": {}, \"before\": {:.17g}, \"after\": {:.17g}, \"score\": {:.17g}}}",
                           found.empty() ? "" : ", ", step.index, step.before, step.after, step.score);
    }
    write_file(options.json, fmt::format("{{\"values\": {}, \"steps\": [{}]}}\n", history.size(), found));
  }
  if (!options.plot.empty()) {
    if (const auto problem = draw(options, history, steps); !problem.empty())
      throw BadData(fmt::format("{}: {}", options.plot, problem));
  }
  const auto broken = broken_gates(history, options.gate);
  const bool gated = options.gate.maximum || options.gate.minimum || options.gate.most_rise;
  if (!gated) return history.empty() ? ExitStatus::bad_data : ExitStatus::passed;
  for (const auto& sentence : broken) fmt::print("gate: {}\n", sentence);
  return broken.empty() ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_history(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("history", "A metric over commits: plot, steps, thresholds");
  auto options = std::make_shared<HistoryOptions>();
  command->add_option("--metric", options->metric, "Measurement, for instance force_rms_N")->required();
  command->add_option("--local", options->local,
                      "File with one JSON object to a line: commit, metric, value [, test, time]");
  command->add_option("--cdash", options->cdash,
                      "Address of a CDash server (token: environment TOUCHSTONE_CDASH_TOKEN)");
  command->add_option("--project", options->project, "The server's project")->capture_default_str();
  command->add_option("--test", options->test, "Name of the test");
  auto* const build =
      command->add_option("--build-id", options->build_id, "With --test-id: through the server's test graph");
  auto* const test = command->add_option("--test-id", options->test_id, "See --build-id");
  build->needs(test);
  test->needs(build);
  command->add_option("--plot", options->plot, "Write the history as PNG");
  command->add_option("--json", options->json, "Write the steps as JSON");
  command->add_option("--max", options->gate.maximum, "Fail when the newest value is above this");
  command->add_option("--min", options->gate.minimum, "Fail when the newest value is below this");
  command->add_option("--max-rise", options->gate.most_rise,
                      "Fail when the newest value exceeds the median before by more than this fraction");
  auto* const value = command->add_option("--record", options->value, "First add this value to the local file");
  command->add_option("--commit", options->commit, "Of the recorded value");
  command->footer(
      "Examples:\n"
      "  touchstone history --cdash https://cdash.example.org --test golden.sphere-scan.god-object --metric "
      "force_rms_N --max 0.01\n"
      "  touchstone history --local history.jsonl --metric operations --max-rise 0.02 --plot operations.png");
  command->callback([options, value, &run] {
    options->record = value->count() > 0;
    run = [options] { return history_command(*options); };
  });
}

}  // namespace touchstone::apps
