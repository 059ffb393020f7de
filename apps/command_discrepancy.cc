#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "apps/axis_recording.h"
#include "apps/commands.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/bundled_files.h"
#include "harness/pipeline/discrepancy/verify.h"
#include "harness/pipeline/discrepancy/workflow.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

struct DiscrepancyOptions {
  pipeline::DiscrepancyFiles files;
  std::filesystem::path json;
  bool verify = false;
  PluginFlags plugins;
};

ExitStatus discrepancy_of_axis(const DiscrepancyOptions& options) {
  const pipeline::DiscrepancyFiles& files = options.files;
  AxisRecording axis{files.recording.string(), files.repeat.string(), files.flip_force,
                     files.out.string(),       options.json.string(), {}};
  const auto has_no_use_for = [&](bool given, const char* flag) {
    if (given) axis.useless.emplace_back(flag);
  };
  has_no_use_for(!files.mesh.empty(), "--mesh");
  has_no_use_for(!files.model.empty(), "--model");
  has_no_use_for(!files.holdout.empty(), "--holdout");
  has_no_use_for(!files.instrument.empty(), "--instrument");
  has_no_use_for(files.tolerance_N || files.unnoticed_passes, "--tolerance");
  has_no_use_for(!files.effects.empty(), "--effect");
  has_no_use_for(!files.golden.empty(), "--golden");
  has_no_use_for(options.verify, "--verify");
  if (files.out.empty()) throw UsageError("--out: a folder for the results is needed");
  return run_axis(axis);
}

ExitStatus discrepancy(DiscrepancyOptions options) {
  if (is_axis_recording(options.files.recording.string())) return discrepancy_of_axis(options);
  if (options.files.model.empty()) throw UsageError("--model is required");
  const plugin::Plugins plugins = options.plugins.load();
  if (!options.plugins.libraries.empty()) options.files.plugins = &plugins;
  const auto say = [](const std::string& line) { fmt::print(stderr, "{}\n", line); };
  if (options.verify) {
    fmt::print("{:.17g} N\n", rms_of_files_N(renderers::built_in_catalogue(), options.files, say));
    return ExitStatus::passed;
  }
  if (options.files.out.empty()) throw UsageError("--out: a folder for the results is needed");
  options.files.command_line = command_line();
  options.files.program = own_program();
  const pipeline::DiscrepancyAnswer answer = run_discrepancy(renderers::built_in_catalogue(), options.files, say);
  if (!options.json.empty()) write_file(options.json, read_file(options.files.out / "findings.json"));
  fmt::print("{}", answer.text);
  return ExitStatus::passed;
}

}  // namespace

void add_discrepancy(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "discrepancy", "Find where simulation and measurement disagree, name the missing effect and show the gap shrink");
  const auto options = std::make_shared<DiscrepancyOptions>();
  command->add_option("--model", options->files.model,
                      "starting model (JSON); needed, but for a recording of one axis");
  command->add_option(
      "--mesh", options->files.mesh,
      "object: OBJ, OFF, PLY or STL; without it the half-space below z = 0, for recordings of "
      "force against displacement (x = y = 0, or a sliding way in x); of a curve with another zero, below "
      "where its contact begins");
  command->add_option("--mesh-unit", options->files.mesh_unit, "unit of the mesh: m, mm, cm or km")
      ->capture_default_str();
  command->add_flag("--repair", options->files.repair,
                    "join open edges that lie within a thousandth of the mesh's size, and turn triangles that face the "
                    "other way than most of their piece, and closed pieces that are inside out");
  command->add_flag("--flip-force", options->files.flip_force,
                    "the files have the force BY the probe: negate it (the holdout's too)");
  command->add_option("--recording", options->files.recording, "measured positions and forces to learn from")
      ->required();
  command->add_option("--holdout", options->files.holdout,
                      "second recording to judge by; without it, alternating blocks of the first are kept back");
  command->add_option("--repeat", options->files.repeat,
                      "the motion of --recording recorded again (it may be the holdout): what the two differ by is the "
                      "floor, and an error within it is not unexplained");
  command->add_option_function<std::string>(
      "--tolerance",
      [options](const std::string& given) {
        options->files.unnoticed_passes = given == "noticed";
        if (options->files.unnoticed_passes) return;
        double newton = 0.0;
        if (!CLI::detail::lexical_cast(given, newton) || !(newton > 0.0 && std::isfinite(newton)))
          throw UsageError(
              fmt::format("--tolerance {}: a force above 0 [N], or the word noticed, was expected", given));
        options->files.tolerance_N = newton;
      },
      "a held-out RMS error that is good enough [N], or `noticed`: less than a fingertip notices at these forces. "
      "Within it nothing counts as missing, though noise leaves less");
  command->add_option("--block", options->files.block_s, "length of those blocks [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--instrument", options->files.instrument,
                      "what the makers of sensor and tracker declare (JSON); without it the noise is estimated");
  command->add_option("--effect", options->files.effects,
                      "an effect of your own (JSON, docs/how-to/declare-an-effect.md), searched for beside those of "
                      "`touchstone list effects`; may be given several times");
  command
      ->add_option_function<std::string>(
          "--in-trajectory",
          [options](const std::string& how) { options->files.synthesize_in_trajectory = how == "synthesize"; },
          "measured: positions as they stand (the default); synthesize: from surface and force, for a rigid object")
      ->check(CLI::IsMember({"synthesize", "measured"}));
  command->add_option("--golden", options->files.golden, "write a golden case of the result into this new folder");
  command->add_option("--out", options->files.out, "folder for report.html, findings.json, model.json");
  command->add_flag("--verify", options->verify,
                    "search nothing: print the RMS force error of the model against the recording");
  command->add_option("--json", options->json, "write the findings here too");
  command->add_option("--seed", options->files.seed, "of the simulated noise")->capture_default_str();
  // Three times what the longest search for two effects took on recordings of 40 s: a limit that ends none of these.
  constexpr double default_time_limit_s = 600.0;
  options->files.time_limit_s = default_time_limit_s;
  command
      ->add_option("--time-limit", options->files.time_limit_s,
                   "for the whole answer: the search ends as much earlier as values, checks and report need, and the "
                   "best answer so far is given with what was not tried; inf: none, the same answer on every machine "
                   "[s]")
      ->check([](const std::string& given) {
        double seconds = 0.0;
        const bool number = CLI::detail::lexical_cast(given, seconds);
        return number && seconds >= 0.0 ? std::string() : "a number of seconds from 0 on, or inf, was expected";
      })
      ->capture_default_str();
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone discrepancy --model base.json --mesh object.obj --recording train.csv --holdout test.csv \\\n"
      "      --instrument sensor.json --out found\n"
      "  touchstone discrepancy --model base.json --mesh object.stl --mesh-unit mm --recording scan.csv --out found\n"
      "  touchstone replay --model found/model.json --mesh object.obj --trajectory test.csv --out rendered.csv\n"
      "  touchstone discrepancy --model base.json --recording curve.csv --out found          (force against depth)\n"
      "  touchstone discrepancy --recording joint.csv --out joint                            (torque over angle)");
  command->callback([options, &run] { run = [options] { return discrepancy(*options); }; });
}

}  // namespace touchstone::apps
