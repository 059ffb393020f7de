#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/metrics/catalogue.h"
#include "harness/pipeline/evaluation/counted_cost.h"
#include "harness/pipeline/evaluation/perceived.h"
#include "harness/rendering/named_declaration.h"
#include "harness/rendering/smooth_field.h"
#include "harness/report/listing.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/trajectory_catalogue.h"

namespace touchstone::apps {
using report::ListedKind;

namespace {

std::vector<report::ListedParameter> declared(const std::vector<rendering::ParameterDeclaration>& declarations) {
  std::vector<report::ListedParameter> parameters;
  parameters.reserve(declarations.size());
  for (const auto& p : declarations) {
    // The coefficients of a field are hundreds of one kind.
    if (rendering::is_field_coefficient(p.name)) {
      if (p.name != rendering::field_coefficient(0, 0)) continue;
      const std::size_t last = rendering::SmoothField::most_side - 1;
      parameters.push_back({p.name + " to " + rendering::field_coefficient(last, last), p.unit, p.meaning, p.initial});
      continue;
    }
    parameters.push_back({p.name, p.unit, p.meaning, p.initial});
  }
  return parameters;
}

template <class Entries>
std::vector<report::ListedItem> synthetic_items(const Entries& entries) {
  std::vector<report::ListedItem> items;
  items.reserve(entries.size());
  for (const auto& entry : entries) items.push_back({entry.name, entry.summary, {}});
  return items;
}

std::string joined_but(const std::vector<std::string>& names, std::string_view left_out) {
  std::string text;
  for (const std::string& name : names) {
    if (name != left_out) text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

std::vector<ListedKind> everything(const CLI::App& program, const plugin::Plugins& plugins) {
  std::vector<ListedKind> kinds;
  ListedKind commands{"commands", "Commands (each has --help with examples)", {}};
  for (const auto* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    commands.items.push_back({command->get_name(), command->get_description(), {}});
  }
  kinds.push_back(std::move(commands));
  ListedKind renderers{"renderers", "Renderers", {}};
  for (const auto& entry : renderers::renderer_catalogue()) {
    renderers.items.push_back(
        {entry.name, fmt::format("{} ({})", entry.summary, entry.source), declared(entry.parameters)});
  }
  for (const auto& entry : plugins.entries()) {
    renderers.items.push_back(
        {entry->name, fmt::format("{} ({}; a plug-in's)", entry->summary, entry->source), declared(entry->parameters)});
  }
  kinds.push_back(std::move(renderers));
  ListedKind effects{"effects", "Effects of the contact (\"effects\" in a model file)", {}};
  for (const auto& entry : renderers::effect_catalogue())
    effects.items.push_back({entry.name, entry.summary, declared(entry.parameters)});
  kinds.push_back(std::move(effects));
  ListedKind instrument{"instrument", "Effects of the measurement (\"instrument\" in a model file)", {}};
  for (const auto& entry : renderers::instrument_declarations()) {
    instrument.items.push_back({entry.name, entry.summary, declared(entry.parameters)});
  }
  kinds.push_back(std::move(instrument));
  ListedKind metrics{"metrics", "Metrics", {}};
  for (const auto& entry : metrics::metric_catalogue()) {
    metrics.items.push_back({entry.name, joined_but(entry.results, ""), {}});
  }
  metrics.items.push_back({"perception", joined_but(pipeline::perceived_metrics(), "perception"), {}});
  metrics.items.push_back({"operations", joined_but(pipeline::operation_metrics(), "operations"), {}});
  kinds.push_back(std::move(metrics));
  kinds.push_back({"surfaces", "Synthetic surfaces (parameters: touchstone synth --list)",
                   synthetic_items(synthetic::surface_catalogue())});
  kinds.push_back({"trajectories", "Synthetic trajectories (parameters: touchstone synth --list)",
                   synthetic_items(synthetic::trajectory_catalogue())});
  return kinds;
}

}  // namespace

void add_list(CLI::App& program, Run& run) {
  struct ListOptions {
    std::string kind;
    std::filesystem::path json;
    PluginFlags plugins;
  };
  auto* const command =
      program.add_subcommand("list", "List commands, renderers, effects, metrics, synthetic surfaces and trajectories");
  const auto options = std::make_shared<ListOptions>();
  command->add_option("kind", options->kind, "only this kind")
      ->check(CLI::IsMember({"commands", "renderers", "effects", "instrument", "metrics", "surfaces", "trajectories"}));
  command->add_option("--json", options->json, "write everything here as JSON");
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n  touchstone list\n  touchstone list effects\n  touchstone list --json catalogue.json\n  touchstone "
      "list renderers --plugin ./libmine.so");
  command->callback([options, &program, &run] {
    run = [options, &program] {
      const auto kinds = everything(program, options->plugins.load());
      if (!options->json.empty()) write_file(options->json, listing_json(kinds));
      for (const ListedKind& kind : kinds) {
        if (options->kind.empty() || options->kind == kind.name) fmt::print("{}", listing_text(kind));
      }
      return ExitStatus::passed;
    };
  });
}

}  // namespace touchstone::apps
