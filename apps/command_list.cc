#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/metrics/catalogue.h"
#include "harness/pipeline/evaluation/counted_cost.h"
#include "harness/pipeline/evaluation/perceived.h"
#include "renderers/catalogue.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/trajectory_catalogue.h"

namespace touchstone::apps {
namespace {

struct Parameter {
  std::string name, unit, meaning;
  double initial = 0.0;
};

struct Item {
  std::string name, summary;
  std::vector<Parameter> parameters;
};

struct Kind {
  std::string name, title;
  std::vector<Item> items;
};

std::vector<Parameter> declared(const std::vector<ParameterDeclaration>& declarations) {
  std::vector<Parameter> parameters;
  parameters.reserve(declarations.size());
  for (const auto& p : declarations) parameters.push_back({p.name, p.unit, p.meaning, p.initial});
  return parameters;
}

template <class Entries>
std::vector<Item> synthetic_items(const Entries& entries) {
  std::vector<Item> items;
  items.reserve(entries.size());
  for (const auto& entry : entries) items.push_back({entry.name, entry.summary, {}});
  return items;
}

std::vector<Kind> everything(const CLI::App& program, const Plugins& plugins) {
  std::vector<Kind> kinds;
  Kind commands{"commands", "Commands (each has --help with examples)", {}};
  for (const auto* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    commands.items.push_back({command->get_name(), command->get_description(), {}});
  }
  kinds.push_back(std::move(commands));
  Kind renderers{"renderers", "Renderers", {}};
  for (const auto& entry : renderer_catalogue()) {
    renderers.items.push_back(
        {entry.name, fmt::format("{} ({})", entry.summary, entry.source), declared(entry.parameters)});
  }
  for (const auto& entry : plugins.entries()) {
    renderers.items.push_back(
        {entry->name, fmt::format("{} ({}; a plug-in's)", entry->summary, entry->source), declared(entry->parameters)});
  }
  kinds.push_back(std::move(renderers));
  Kind effects{"effects", "Effects of the contact (\"effects\" in a model file)", {}};
  for (const auto& entry : effect_catalogue())
    effects.items.push_back({entry.name, entry.summary, declared(entry.parameters)});
  kinds.push_back(std::move(effects));
  Kind instrument{"instrument", "Effects of the measurement (\"instrument\" in a model file)", {}};
  for (const auto& entry : instrument_declarations()) {
    instrument.items.push_back({entry.name, entry.summary, declared(entry.parameters)});
  }
  kinds.push_back(std::move(instrument));
  Kind metrics{"metrics", "Metrics", {}};
  for (const auto& entry : metric_catalogue()) {
    std::string results;
    for (const auto& result : entry.results) results += (results.empty() ? "" : ", ") + result;
    metrics.items.push_back({entry.name, results, {}});
  }
  {
    std::string results;
    for (const auto& name : perceived_metrics()) {
      if (name != "perception") results += (results.empty() ? "" : ", ") + name;
    }
    metrics.items.push_back({"perception", results, {}});
    results.clear();
    for (const auto& name : operation_metrics()) {
      if (name != "operations") results += (results.empty() ? "" : ", ") + name;
    }
    metrics.items.push_back({"operations", results, {}});
  }
  kinds.push_back(std::move(metrics));
  kinds.push_back({"surfaces", "Synthetic surfaces (parameters: touchstone synth --list)",
                   synthetic_items(synthetic::surface_catalogue())});
  kinds.push_back({"trajectories", "Synthetic trajectories (parameters: touchstone synth --list)",
                   synthetic_items(synthetic::trajectory_catalogue())});
  return kinds;
}

void print(const Kind& kind) {
  fmt::print("{}\n", kind.title);
  std::size_t width = 0;
  for (const Item& item : kind.items) width = std::max(width, item.name.size());
  for (const Item& item : kind.items) {
    fmt::print("  {:{}}  {}\n", item.name, width, item.summary);
    for (const Parameter& p : item.parameters) {
      fmt::print("  {:{}}    {} [{}], {:g} where not set: {}\n", "", width, p.name, p.unit, p.initial, p.meaning);
    }
  }
  fmt::print("\n");
}

std::string to_json(const std::vector<Kind>& kinds) {
  nlohmann::ordered_json root;
  root["schema"] = "touchstone-list/1";
  for (const Kind& kind : kinds) {
    auto& items = root[kind.name] = nlohmann::ordered_json::array();
    for (const Item& item : kind.items) {
      nlohmann::ordered_json entry{{"name", item.name}, {"summary", item.summary}};
      for (const Parameter& p : item.parameters) {
        entry["parameters"].push_back(
            {{"name", p.name}, {"unit", p.unit}, {"default", p.initial}, {"meaning", p.meaning}});
      }
      items.push_back(std::move(entry));
    }
  }
  return root.dump(2) + "\n";
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
      if (!options->json.empty()) write_file(options->json, to_json(kinds));
      for (const Kind& kind : kinds) {
        if (options->kind.empty() || options->kind == kind.name) print(kind);
      }
      return ExitStatus::passed;
    };
  });
}

}  // namespace touchstone::apps
