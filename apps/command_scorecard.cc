#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "apps/catalogues.h"
#include "apps/commands.h"
#include "apps/golden_options.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/progress.h"
#include "harness/diagnosis/entry_engine.h"
#include "harness/diagnosis/scorecard.h"
#include "harness/pipeline/golden/case_runner.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

struct ScorecardOptions {
  PluginFlags plugins;
  std::vector<std::string> renderers;
  std::vector<std::string> parameters;
  diagnosis::EngineFacts facts;
  FeltTolerance felt;
  std::string golden = "golden";
  std::string model = "god-object";
  std::string out = "scorecard";
  bool no_cases = false;
  bool no_cost = false;
};

std::map<std::string, double> scorecard_parameters(const std::vector<std::string>& given) {
  std::map<std::string, double> values;
  for (const std::string& one : given) {
    const auto equals = one.find('=');
    std::size_t used = 0;
    try {
      if (equals != std::string::npos) values[one.substr(0, equals)] = std::stod(one.substr(equals + 1), &used);
    } catch (const std::logic_error&) {
      used = 0;
    }
    if (used == 0 || used != one.size() - equals - 1)
      throw UsageError(fmt::format("--parameter {}: NAME=NUMBER was expected", one));
  }
  return values;
}

// The plug-ins' renderers and, by name, the program's own.
std::vector<std::shared_ptr<const RendererEntry>> chosen_entries(const ScorecardOptions& options,
                                                                 const Plugins& plugins) {
  std::vector<std::shared_ptr<const RendererEntry>> all = plugins.entries();
  for (const RendererEntry& entry : renderer_catalogue()) all.push_back(std::make_shared<const RendererEntry>(entry));
  if (options.renderers.empty()) {
    if (plugins.entries().empty()) throw UsageError("give --plugin libmine.so, or --renderer with a renderer's name");
    return plugins.entries();
  }
  std::vector<std::shared_ptr<const RendererEntry>> chosen;
  for (const std::string& name : options.renderers) {
    const auto found = std::ranges::find_if(all, [&](const auto& entry) { return entry->name == name; });
    if (found == all.end()) {
      std::string known;
      for (const auto& entry : all) known += ' ' + entry->name;
      throw UsageError(fmt::format("--renderer {}: there is none of this name; there are:{}", name, known));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

// The renderer in the place of the case's own, with the case's stiffness and tip and the parameters that were given.
ChangeModel in_place(const std::shared_ptr<const RendererEntry>& entry, const ScorecardOptions& options) {
  return [entry, given = options.facts.parameters](Model& model) {
    model.renderer = entry->name;
    model.provided = entry;
    std::erase_if(model.parameters, [&](const auto& parameter) {
      return std::ranges::find(entry->parameters, parameter.first, &ParameterDeclaration::name) ==
             entry->parameters.end();
    });
    for (const auto& [name, value] : given) {
      if (name != "stiffness_N_per_m") model.parameters[name] = value;
    }
  };
}

diagnosis::CaseScore scorecard_case(const GoldenCase& golden, const ScorecardOptions& options,
                                    const ChangeModel& change) {
  diagnosis::CaseScore score;
  score.name = golden.name;
  try {
    const CheckResult checked = check_case(built_in_catalogues(), golden, options.model,
                                           {std::filesystem::path(options.out) / "cases", false, change, options.felt});
    score.problem = checked.skipped;
    if (!score.problem.empty()) return score;
    if (!checked.felt) {
      score.problem = checked.comparison.problems.empty() ? "it did not run" : checked.comparison.problems.front();
      return score;
    }
    score.reference = checked.felt->reference;
    score.rms_N = checked.felt->rms_N;
    score.max_N = checked.felt->max_N;
    score.max_jnd = checked.felt->max_jnd;
    score.felt = checked.felt->passed;
    score.exact = passes(checked.comparison.verdict);
  } catch (const Error& error) {
    score.problem = error.what();
  }
  return score;
}

diagnosis::Scorecard scorecard_of(const std::shared_ptr<const RendererEntry>& entry, const ScorecardOptions& options,
                                  const std::vector<GoldenCase>& cases) {
  diagnosis::Scorecard card;
  card.engine = entry->name;
  card.summary = entry->summary;
  card.source = entry->source;
  if (!entry->library.empty()) {
    card.library = entry->library.filename().string();
    card.library_sha256 = sha256_file(entry->library);
  }
  for (const std::string& parameter : options.parameters) card.options += parameter + " ";
  card.felt_tolerance_jnd = options.felt.jnd;
  const diagnosis::Engine engine = diagnosis::engine_of(*entry, options.facts);
  card.epsilon_m = engine.epsilon_m;
  card.world_unit_m = entry->world_unit_m;
  card.diagnosis = diagnosis::diagnose(engine);
  constexpr int levels = 5;  // 8192 triangles
  if (!options.no_cost) card.cost = diagnosis::measure_cost(engine, levels);
  ScorecardOptions with_epsilon = options;
  with_epsilon.felt.epsilon_m = engine.epsilon_m;
  for (const GoldenCase& golden : cases) {
    if (golden.models.contains(options.model))
      card.cases.push_back(scorecard_case(golden, with_epsilon, in_place(entry, options)));
  }
  return card;
}

ExitStatus scorecard_command(const ScorecardOptions& given) {
  ScorecardOptions options = given;
  options.facts.parameters = scorecard_parameters(options.parameters);
  options.facts.epsilon_m = options.felt.epsilon_m;
  const Plugins plugins = options.plugins.load();
  GoldenOptions golden;
  golden.golden = options.golden;
  const auto entries = chosen_entries(options, plugins);
  const std::vector<GoldenCase> cases = options.no_cases ? std::vector<GoldenCase>{} : golden.load();
  const std::filesystem::path out = options.out;
  ensure_writable_folder(out);
  std::vector<diagnosis::Scorecard> cards;
  bool clean = true;
  for (const auto& entry : entries) {
    cards.push_back(scorecard_of(entry, options, cases));
    const diagnosis::Scorecard& card = cards.back();
    write_file(out / (card.engine + ".json"), diagnosis::scorecard_to_json(card));
    fmt::print("{}", diagnosis::scorecard_to_text(card));
    clean = clean && card.diagnosis.findings.empty() && card.diagnosis.failed.empty();
  }
  write_file(out / "index.html", diagnosis::scorecard_to_html(cards));
  fmt::print("scorecard: {}\n", (out / "index.html").string());
  return clean ? ExitStatus::passed : ExitStatus::failed;
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
  command->add_option("--stiffness", options->facts.stiffness_N_per_m,
                      "The steepest rise of force with depth [N/m]; the parameter stiffness_N_per_m where not given");
  command->add_option("--friction", options->facts.friction, "The largest tangential over normal force")
      ->capture_default_str();
  command->add_option("--tip-radius", options->facts.tip_radius_m, "Where the tip is a ball [m]")
      ->capture_default_str();
  command->add_option("--epsilon", options->felt.epsilon_m, "Lengths below it are nothing to the renderer [m]")
      ->capture_default_str();
  command
      ->add_option("--felt-tolerance", options->felt.jnd,
                   "The largest error that passes as felt, in just noticeable differences")
      ->capture_default_str();
  command->add_option("--golden", options->golden, "Folder of the golden cases")->capture_default_str();
  command->add_option("--model", options->model, "The model of the golden cases whose place the renderer takes")
      ->capture_default_str();
  command->add_flag("--no-cases", options->no_cases, "Diagnoses and cost alone");
  command->add_flag("--no-cost", options->no_cost, "No timing");
  command->add_option("--out", options->out, "Folder: index.html, and a JSON per renderer")->capture_default_str();
  command->footer(
      "Exit status: 0 nothing found, 1 a fault was found.\nExamples:\n"
      "  touchstone scorecard --plugin ./libmine.so --plugin-in-process\n"
      "  touchstone scorecard --renderer god-object --renderer penalty --out card");
  command->callback([options, &run] { run = [options] { return scorecard_command(*options); }; });
}

}  // namespace touchstone::apps
