#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "apps/evaluation_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/metrics/catalogue.h"
#include "harness/pipeline/evaluation/campaign.h"
#include "harness/pipeline/evaluation/counted_cost.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/evaluation/perceived.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
using pipeline::PlannedEvaluation;

namespace {

constexpr const char* default_out = "touchstone-report";

struct EvaluateOptions {
  EvaluationFlags flags;
  std::vector<std::string> models, datasets, metrics;
  std::string out = default_out, json, time_range = "all";
};

std::vector<PlannedEvaluation> plan(const EvaluateOptions& options) {
  pipeline::EvaluationRequest base = make_request(options.flags);
  base.metrics = options.metrics;
  for (const std::string& name : options.metrics) {
    if (!pipeline::is_perceived_metric(name) && !pipeline::is_operation_metric(name)) metrics::find_metric(name);
  }
  base.time_ranges = metrics::TimeRanges::parse(options.time_range, "--time-range");
  const plugin::Plugins plugins = options.flags.plugins.load();
  std::vector<pipeline::ModelOfFile> models;
  for (const std::filesystem::path file : options.models) models.emplace_back(load_model(file, plugins), file);
  std::vector<PlannedEvaluation> out;
  if (options.flags.recording.empty() && !base.repeat.empty()) {
    throw UsageError("--repeat belongs to --recording: it is that motion recorded again");
  }
  if (!options.flags.recording.empty() || !options.flags.mesh.empty()) {
    if (options.flags.recording.empty() || options.flags.mesh.empty() || models.empty()) {
      throw UsageError(
          "--recording, --mesh and --model belong together; give all three, or a --dataset, or none for the bundled "
          "data sets");
    }
    if (options.flags.in_trajectory.empty()) {
      base.in_trajectory =
          pipeline::usual_in_trajectory(std::ranges::any_of(models, [](const pipeline::ModelOfFile& model) {
            return pipeline::has_friction_in_proxy(renderers::built_in_catalogue(), model.first);
          }));
      say_usual_in_trajectory(base.in_trajectory);
    }
    return plan_recording(base, models);
  }
  std::vector<std::filesystem::path> datasets(options.datasets.begin(), options.datasets.end());
  if (datasets.empty()) datasets = pipeline::bundled_datasets();
  for (const auto& dataset : datasets) {
    for (PlannedEvaluation& one : plan_dataset(renderers::built_in_catalogue(), dataset, models, plugins, base,
                                               !options.flags.in_trajectory.empty()))
      out.push_back(std::move(one));
  }
  return out;
}

ExitStatus evaluate_command(const EvaluateOptions& options) {
  const auto planned = plan(options);
  ensure_writable_folder(options.out);
  if (options.out == default_out) hide_from_git(options.out);
  const auto evaluated = run_plan(renderers::built_in_catalogue(), planned, options.out);
  fmt::print("{}", write_overview(renderers::built_in_catalogue(), planned, evaluated, command_line(), options.out));
  if (!options.json.empty()) write_file(options.json, summary_json(evaluated));
  const bool invalid = std::ranges::any_of(evaluated, pipeline::is_invalid);
  const bool none =
      std::ranges::all_of(evaluated, [](const pipeline::Evaluated& one) { return !one.does_not_enter.empty(); });
  if (none) throw UsageError(evaluated.front().does_not_enter);
  return invalid ? ExitStatus::failed : ExitStatus::passed;
}

}  // namespace

void add_evaluate(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "evaluate",
      "Hold a renderer's forces, positions and cost against a real recording; without options every renderer on the "
      "bundled recordings");
  auto options = std::make_shared<EvaluateOptions>();
  add_evaluation_flags(*command, options->flags);
  command->add_option("--model", options->models, "Model file (touchstone-model/1); several are put side by side");
  command->add_option("--dataset", options->datasets,
                      "Folder with dataset.json: object, tip and recordings; may be given several times");
  command
      ->add_option("--metrics", options->metrics,
                   "Metrics or results by name, see `touchstone list`, or perception; all where not given")
      ->delimiter(',');
  command
      ->add_option("--time-range", options->time_range, "What the metrics see: 0:6,12:18 in seconds, even:6s, odd:6s")
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for report.html, result.json and rendered.csv")
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the metrics of all evaluations to this file");
  command->footer(
      "Examples:\n"
      "  touchstone evaluate\n"
      "  touchstone evaluate --recording press.csv --mesh object.obj --mesh-unit mm --model god-object.json --out "
      "report\n"
      "  touchstone evaluate --recording soft.csv --mesh centres.obj --mesh-unit mm --model k800.json \\\n"
      "      --in-trajectory measured --threshold 0.2N --time-range odd:6s --out soft\n"
      "  touchstone evaluate --plugin ./libmine.so --model mine.json --model god-object.json --dataset plate\n"
      "  touchstone evaluate --dataset plate --model a.json --model b.json --json summary.json");
  command->callback([options, &run] { run = [options] { return evaluate_command(*options); }; });
}

}  // namespace touchstone::apps
