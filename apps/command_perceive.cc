#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/named_values.h"
#include "harness/pipeline/perceiving/by_paper.h"
#include "harness/pipeline/perceiving/judging.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
using pipeline::PerceiveRequest;

namespace {

struct PerceiveOptions {
  PerceiveRequest request;
  std::string out, method = "judge", in_trajectory;
  std::vector<std::string> conditions, models;
  PluginFlags plugins;
};

void print_notes(const std::vector<std::string>& notes) {
  for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
}

void perceive_by_judge(const PerceiveRequest& request, const std::filesystem::path& out) {
  if (!request.paper.answers.empty()) throw UsageError("--answers goes with --method paper");
  if (request.paper.explained_share)
    throw UsageError("--explained goes with --method paper; the judge has no dimensions");
  const pipeline::JudgedFiles files = judge_files(renderers::built_in_catalogue(), request);
  write_judged(files, out);
  fmt::print("{}", files.table());
  print_notes(files.remarks());
  fmt::print("{} and {}\n", (out / "report.html").string(), (out / "perception.json").string());
}

void perceive_by_paper(const PerceiveRequest& request, const std::filesystem::path& out) {
  const pipeline::PaperFiles files = evaluate_by_paper(renderers::built_in_catalogue(), request);
  write_by_paper(files, out);
  fmt::print("{}", files.table());
  print_notes(files.evaluation.remarks);
  const auto& space = files.evaluation.space;
  fmt::print("{} of {} dimensions explain {:.1f} %; {} and {}\n", space.dimensions, space.available,
             100.0 * space.explained_share, (out / "report.html").string(), (out / "perception.json").string());
}

ExitStatus perceive_command(const PerceiveOptions& options) {
  if (options.conditions.empty() && options.models.empty()) {
    throw UsageError("at least one --condition NAME=FILE or --model NAME=MODEL is needed");
  }
  if (!options.models.empty() && options.request.mesh.empty())
    throw UsageError("--model needs --mesh, the object that it renders");
  ensure_writable_folder(options.out);
  PerceiveRequest request = options.request;
  request.command_line = command_line();
  request.in_trajectory = recording::find_in_trajectory(options.in_trajectory);
  for (const auto& text : options.conditions) {
    const auto [name, file] = named_file("--condition", text);
    request.conditions.push_back({name, file});
  }
  const plugin::Plugins plugins = options.plugins.load();
  for (const auto& text : options.models) {
    const auto [name, file] = named_file("--model", text);
    request.models.push_back({name, file, load_model(file, plugins)});
  }
  options.method == "paper" ? perceive_by_paper(request, options.out) : perceive_by_judge(request, options.out);
  return ExitStatus::passed;
}

// Of --method paper.
void add_paper_flags(CLI::App& command, PerceiveOptions& options) {
  command.add_option("--answers", options.request.paper.answers,
                     "Paper: paired comparisons, CSV with subject,first,second,chosen");
  command
      .add_option("--scaling", options.request.paper.scaling,
                  "Paper: scaling of features: reference-norm, none, block-spread, standardised, pooled-range")
      ->capture_default_str();
  command.add_option("--explained", options.request.paper.explained_share,
                     "Paper: share of the variance that the dimensions explain: 0.9, as in the paper, if not given");
  command.add_option("--window", options.request.paper.window, "Paper: window of rate-hardness in samples")
      ->capture_default_str();
  command.add_flag("--hardness-in-band", options.request.paper.hardness_in_band,
                   "Paper: rate-hardness after the output band rather than as measured");
  command
      .add_option("--band", options.request.paper.band_Hz,
                  "Paper: output band of the finger in Hz (2-6 in the literature), 0 for none")
      ->capture_default_str();
  command.add_option("--dead-zone", options.request.paper.dead_zone_N, "Paper: dead zone of the force sensor in N")
      ->capture_default_str();
  command
      .add_option("--rate", options.request.paper.rate_Hz,
                  "Paper: common rate in Hz; 0: the real recording's median rate")
      ->capture_default_str();
  command
      .add_option("--duration-tolerance", options.request.paper.duration_tolerance,
                  "Paper: durations may differ by this share of the real one")
      ->capture_default_str();
}

}  // namespace

void add_perceive(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "perceive",
      "Say for each rendering how likely a person tells it from the real thing, by which channel, and what to change");
  auto options = std::make_shared<PerceiveOptions>();
  command->add_option("--real", options->request.real, "Recording of the real process (CSV or HDF5)")->required();
  command->add_option("--condition", options->conditions, "NAME=FILE, a recording of a condition; repeat for more");
  command->add_option("--model", options->models, "NAME=MODEL, a condition that a model renders along the real path");
  command->add_option("--mesh", options->request.mesh, "The object that models render");
  command
      ->add_option("--mesh-unit", options->request.mesh_unit,
                   "Unit of the mesh's coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  command
      ->add_option(
          "--in-trajectory", options->in_trajectory,
          "What models are fed: measured, synthesize (equation 2, from the normal force) or whole-force; not given: "
          "measured, and where the real tip stays on the surface, as of a rigid object, as evaluate chooses")
      ->check(CLI::IsMember({"measured", "synthesize", "whole-force"}));
  command->add_option(
      "--repeat", options->request.repeats,
      "Another recording of the real process: how much they differ is the noise floor; repeat for more");
  command->add_flag("--flip-force", options->request.flip_force,
                    "The recordings have the force BY the probe: negate it, in all of them");
  command
      ->add_option("--method", options->method,
                   "judge: probability of noticing, pair by pair; paper: the distance in perception space of Shao, Wu "
                   "and Ouyang")
      ->check(CLI::IsMember({"judge", "paper"}))
      ->capture_default_str();
  command->add_option(
      "--thresholds", options->request.judge.thresholds,
      "JSON that replaces just noticeable differences; perception.json holds those in use, with their sources");
  command->add_flag("--depth-known", options->request.judge.depth_known,
                    "The hand is led to the same depth, or presses to a stop, so that forces can be compared there; "
                    "without it, an error of the depth hides differences of the force");
  command->add_option("--instrument", options->request.judge.instrument,
                      "What the makers declare (touchstone-instrument/1), for the noise floor without repeats");
  command->add_option("--without", options->request.judge.without,
                      "Leave a channel out of the sum, e.g. position where the frames of the recordings differ");
  command->add_option(
      "--extend-edges", options->request.extend_edges,
      "Continue open edges of the mesh by this width, with its unit (2mm), 0 for none; as needed if not "
      "given");
  command->add_option("--out", options->out, "Folder for perception.json and report.html")->required();
  command
      ->add_option("--direction", options->request.direction,
                   "Outward direction of pressing: force (that of the real process), +x, -x, +y, -y, +z, -z")
      ->capture_default_str();
  add_paper_flags(*command, *options);
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone perceive --real spring.csv --repeat again.csv --condition omega=omega.csv --condition "
      "touch=touch.csv "
      "--out perceived\n"
      "  touchstone perceive --real press.csv --model stiff=stiff.json --model soft=soft.json --mesh phantom.obj "
      "--mesh-unit mm --out perceived\n"
      "  touchstone perceive --real spring.csv --condition a=a.csv --condition b=b.csv --condition c=c.csv "
      "--method paper --answers answers.csv --out perceived");
  command->callback([options, &run] { run = [options] { return perceive_command(*options); }; });
}

}  // namespace touchstone::apps
