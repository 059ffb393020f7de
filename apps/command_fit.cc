#include <fmt/format.h>

#include <memory>

#include "apps/axis_recording.h"
#include "apps/commands.h"
#include "apps/evaluation_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/input_files.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/fitting/fit_report.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

constexpr const char* fit_folder = "touchstone-fit";

struct FitOptions {
  EvaluationFlags flags;
  std::vector<std::string> parameters;
  std::string model, metric = "rms_force_error", fit_range = "all", score_range = "all", out = fit_folder, json;
};

ExitStatus fit_of_axis(const FitOptions& options) {
  AxisRecording axis{
      options.flags.recording, options.flags.repeat, options.flags.flip_force, options.out, options.json, {}};
  const auto has_no_use_for = [&](bool given, const char* flag) {
    if (given) axis.useless.emplace_back(flag);
  };
  has_no_use_for(!options.flags.mesh.empty(), "--mesh");
  has_no_use_for(!options.model.empty(), "--model");
  has_no_use_for(!options.parameters.empty(), "--parameter");
  has_no_use_for(options.fit_range != "all", "--fit-range");
  has_no_use_for(options.score_range != "all", "--score-range");
  return run_axis(axis);
}

void need(bool given, const char* flag) {
  if (!given) throw UsageError(fmt::format("{} is required", flag));
}

ExitStatus fit_command(const FitOptions& options) {
  if (is_axis_recording(options.flags.recording)) return fit_of_axis(options);
  need(!options.flags.mesh.empty(), "--mesh");
  need(!options.model.empty(), "--model");
  need(!options.parameters.empty(), "--parameter");
  pipeline::FitRequest request;
  request.evaluation = make_request(options.flags);
  request.fit_range = metrics::TimeRanges::parse(options.fit_range, "--fit-range");
  request.score_range = metrics::TimeRanges::parse(options.score_range, "--score-range");
  request.metric = options.metric;
  request.parameters = options.parameters;
  request.evaluation.model = load_model(options.model, options.flags.plugins.load());
  request.evaluation.model_file = options.model;
  if (options.flags.in_trajectory.empty()) {
    std::vector<std::string> fitted;
    for (const std::string& parameter : options.parameters) fitted.push_back(parameter.substr(0, parameter.find('=')));
    request.evaluation.in_trajectory = pipeline::usual_in_trajectory(
        pipeline::has_friction_in_proxy(renderers::built_in_catalogue(), request.evaluation.model, fitted));
    say_usual_in_trajectory(request.evaluation.in_trajectory);
  }
  ensure_writable_folder(options.out);
  if (options.out == fit_folder) hide_from_git(options.out);
  refuse_to_replace_input(std::filesystem::path(options.out) / "model.json");  // before the long work
  const pipeline::FitResult result = run_fit(renderers::built_in_catalogue(), request);
  write_fit(result, options.out);
  if (!options.json.empty()) write_file(options.json, fit_to_json(result));
  fmt::print("{}\n", fit_table(result));
  for (const std::string& note : result.notes) fmt::print(stderr, "{}\n", note);
  for (const std::string& warning : result.warnings) fmt::print(stderr, "warning: {}\n", warning);
  fmt::print("{}\nreport: {}/report.html\n", result.interval_note, options.out);
  return ExitStatus::passed;
}

}  // namespace

void add_fit(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "fit", "Identify parameters of a model from a recording, and score them on another part of it");
  auto options = std::make_shared<FitOptions>();
  add_evaluation_flags(*command, options->flags);
  command->get_option("--recording")->required();
  command->add_option("--model", options->model, "Model file; its values are where the search starts");
  command->add_option(
      "--parameter", options->parameters,
      "What to fit: NAME or NAME=low:high, ENTRY.NAME for effects and instrument; may be given several times");
  command->add_option("--metric", options->metric, "What to minimise: a force metric")->capture_default_str();
  command->add_option("--fit-range", options->fit_range, "Fitted time ranges: 0:6,12:18 in seconds, even:6s, odd:6s")
      ->capture_default_str();
  command->add_option("--score-range", options->score_range, "Time ranges to score on")->capture_default_str();
  command->add_option("--out", options->out, "Folder for model.json, fit.json and report.html")->capture_default_str();
  command->add_option("--json", options->json, "Write fit.json here too");
  command->footer(
      "--mesh, --model and --parameter are needed, but for a recording of one axis (q_rad and torque_Nm, or q_m and "
      "force_N), which is fitted as `touchstone axis` does.\n"
      "Examples:\n"
      "  touchstone fit --parameter stiffness_N_per_m=100:5000 --model k500.json --recording press.csv --mesh "
      "centres.obj --mesh-unit mm \\\n"
      "      --in-trajectory measured --fit-range even:6s --score-range odd:6s --out fit\n"
      "  touchstone fit --parameter coulomb-friction.mu_dynamic=0:1 --model friction.json --recording scan.csv --mesh "
      "duck.obj --out fit\n"
      "  touchstone fit --recording joint.csv --out joint");
  command->callback([options, &run] { run = [options] { return fit_command(*options); }; });
}

}  // namespace touchstone::apps
