#include "listing.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "recipe.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/trajectory_catalogue.h"

namespace touchstone::datasets {
using synthetic::Parameter;
using synthetic::surface_catalogue;
using synthetic::trajectory_catalogue;

namespace {

std::string range(const Parameter& p) {
  // Lengths go over every scale that a double serves well: no need to say it in each line.
  if (p.maximum >= 1e6) return p.minimum > 0.0 ? "> 0" : (p.minimum == 0.0 ? ">= 0" : "any");
  return fmt::format("{:.6g} to {:.6g}", p.minimum, p.maximum);
}

template <class Entry>
std::string table(std::span<const Entry> entries) {
  std::string text = "| name | parameter | unit | range | default | meaning |\n|---|---|---|---|---|---|\n";
  for (const Entry& entry : entries) {
    text += fmt::format("| **{}** | | | | | {} |\n", entry.name, entry.summary);
    for (const Parameter& p : entry.parameters) {
      text += fmt::format("| | `{}` | {} | {} | {:.6g} | {} |\n", p.name, p.unit, range(p), p.initial, p.meaning);
    }
  }
  return text;
}

template <class Entry>
nlohmann::ordered_json entries_json(std::span<const Entry> entries) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Entry& entry : entries) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (const Parameter& p : entry.parameters) {
      parameters.push_back({{"name", p.name},
                            {"unit", p.unit},
                            {"minimum", p.minimum},
                            {"maximum", p.maximum},
                            {"default", p.initial},
                            {"meaning", p.meaning}});
    }
    list.push_back({{"name", entry.name}, {"summary", entry.summary}, {"parameters", parameters}});
  }
  return list;
}

}  // namespace

std::string catalogue_markdown() {
  std::string text = "## Data sets\n\n| name | object | shows |\n|---|---|---|\n";
  for (const Recipe& r : recipes()) text += fmt::format("| **{}** | {} | {} |\n", r.name, r.object, r.shows);
  text += "\n## Surfaces\n\n" + table(surface_catalogue());
  text += "\n## Trajectories\n\n" + table(trajectory_catalogue());
  return text;
}

std::string catalogue_json() {
  nlohmann::ordered_json root{{"schema", "touchstone-synthetic/1"}};
  for (const Recipe& r : recipes())
    root["datasets"].push_back({{"name", r.name}, {"object", r.object}, {"shows", r.shows}});
  root["surfaces"] = entries_json(surface_catalogue());
  root["trajectories"] = entries_json(trajectory_catalogue());
  return root.dump(1) + "\n";
}

}  // namespace touchstone::datasets
