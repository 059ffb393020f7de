#include <fmt/format.h>

#include <filesystem>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/named_values.h"
#include "harness/golden/scored_renderer.h"
#include "harness/renderer_faults/scorecard.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

struct ScorecardOptions {
  PluginFlags plugins;
  std::vector<std::string> renderers;
  std::vector<std::string> parameters;
  golden::ScoreRequest request{{}, {}, "", "god-object", true, true, {}, "scorecard"};
  std::string golden = "golden";
  bool no_cases = false;
  bool no_cost = false;
};

ExitStatus scorecard_command(const ScorecardOptions& options) {
  golden::ScoreRequest request = options.request;
  request.cost = !options.no_cost;
  request.with_cases = !options.no_cases;
  for (const auto& [name, value] : named_values("--parameter", options.parameters)) {
    request.facts.parameters[name] = value;
  }
  request.facts.epsilon_m = request.felt.epsilon_m;
  for (const std::string& parameter : options.parameters) request.options += parameter + " ";
  const plugin::Plugins plugins = options.plugins.load();
  GoldenOptions golden;
  golden.golden = options.golden;
  const auto entries = golden::entries_to_score(renderers::renderer_catalogue(), plugins, options.renderers);
  const std::vector<golden::GoldenCase> cases = options.no_cases ? std::vector<golden::GoldenCase>{} : golden.load();
  const std::filesystem::path out = request.out;
  ensure_writable_folder(out);
  std::vector<renderer_faults::Scorecard> cards;
  bool failed = false;
  bool skipped = false;
  for (const auto& entry : entries) {
    cards.push_back(score_renderer(built_in_catalogues(), entry, request, cases));
    const renderer_faults::Scorecard& card = cards.back();
    write_file(out / (card.engine + ".json"), renderer_faults::scorecard_to_json(card));
    fmt::print("{}", renderer_faults::scorecard_to_text(card));
    failed = failed || verdict_of(card) == renderer_faults::CardVerdict::failed;
    skipped = skipped || verdict_of(card) == renderer_faults::CardVerdict::skipped;
  }
  write_file(out / "index.html", renderer_faults::scorecard_to_html(cards));
  write_file(out / "shapes.md", renderer_faults::scorecard_to_markdown(cards));
  fmt::print("scorecard: {}\n", (out / "index.html").string());
  if (failed) return ExitStatus::failed;
  return skipped ? ExitStatus::skipped : ExitStatus::passed;
}

}  // namespace

void add_scorecard(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "scorecard", "What is wrong with a renderer, by name, with the smallest case that shows it");
  auto options = std::make_shared<ScorecardOptions>();
  options->plugins.add_to(*command);
  command->add_option("--renderer", options->renderers,
                      "Renderers to judge, side by side: the plug-ins' or the program's own; all of the plug-ins where "
                      "not given");
  command->add_option("--parameter", options->parameters, "NAME=NUMBER, another value than the renderer's default");
  command->add_option("--stiffness", options->request.facts.stiffness_N_per_m,
                      "The steepest rise of force with depth [N/m]; the parameter stiffness_N_per_m where not given");
  command->add_option(
      "--friction", options->request.facts.friction,
      "The largest tangential over normal force; the larger of mu_static and mu_dynamic where not given");
  command->add_option("--tip-radius", options->request.facts.tip_radius_m,
                      "Where the tip is a ball [m]; the parameter tip_radius_m where not given");
  command->add_option("--epsilon", options->request.felt.epsilon_m, "Lengths below it are nothing to the renderer [m]")
      ->capture_default_str();
  command
      ->add_option("--felt-tolerance", options->request.felt.jnd,
                   "The largest error that passes as felt, in just noticeable differences")
      ->capture_default_str();
  command->add_option("--golden", options->golden, "Folder of the golden cases")->capture_default_str();
  command->add_option("--model", options->request.model, "The model of the golden cases whose place the renderer takes")
      ->capture_default_str();
  command->add_option("--allow", options->request.allowed,
                      "A fault or a golden case that is known to fail: it is reported and does not count");
  command->add_flag("--no-cases", options->no_cases, "Diagnoses and cost alone");
  command->add_flag("--no-cost", options->no_cost, "No timing");
  command
      ->add_option("--out", options->request.out,
                   "Folder: index.html, a JSON per renderer, and shapes.md (errors of each shape by renderer)")
      ->capture_default_str();
  command->footer(
      "Exit status: 0 nothing found, 1 a fault was found or a golden case has an error that a hand would notice, 77 no "
      "golden case ran.\nExamples:\n"
      "  touchstone scorecard --plugin ./libmine.so --plugin-in-process\n"
      "  touchstone scorecard --plugin ./libmine.so --plugin-in-process --allow delay --allow sphere-jumps\n"
      "  touchstone scorecard --renderer god-object --renderer penalty --out card");
  command->callback([options, &run] { run = [options] { return scorecard_command(*options); }; });
}

}  // namespace touchstone::apps
