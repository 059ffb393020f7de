#include "apps/golden_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"

namespace touchstone::apps {

void GoldenOptions::add_to(CLI::App& command) {
  command.add_option("CASE", cases, "Names of cases, or folders; all where none is given");
  command.add_option("--model", model, "Only this model of the cases");
  command.add_option("--renderer", renderer,
                     "Run this renderer in place of the models' own: whether another implementation gives the same");
  plugins.add_to(command);
  command.add_option("--golden", golden, "Folder of the golden cases")
      ->envname("TOUCHSTONE_GOLDEN")
      ->capture_default_str();
  command.add_option("--out", out, "Folder for what failures leave behind")
      ->envname("TOUCHSTONE_GOLDEN_OUT")
      ->capture_default_str();
}

std::vector<GoldenCase> GoldenOptions::load() const {
  if (cases.empty()) return load_cases(golden);
  std::vector<GoldenCase> chosen;
  for (const std::string& name : cases) {
    const bool folder = name.find('/') != std::string::npos;
    std::filesystem::path path = folder ? std::filesystem::path(name) : std::filesystem::path(golden) / name;
    if (!path.has_filename()) path = path.parent_path();
    if (!std::filesystem::is_directory(path)) {
      std::string known;
      for (const GoldenCase& one : load_cases(golden)) known += ' ' + one.name;
      throw UsageError(fmt::format("there is no golden case '{}' in {}; there are:{}", name, golden, known));
    }
    chosen.push_back(load_case(path));
  }
  return chosen;
}

std::vector<std::string> GoldenOptions::models_of(const GoldenCase& one) const {
  if (!model.empty()) return {model};
  std::vector<std::string> models;
  for (const auto& [name, ignored] : one.models) models.push_back(name);
  return models;
}

ChangeModel GoldenOptions::change_model() const {
  return [loaded = plugins.load(), name = renderer](Model& changed) {
    if (!name.empty()) changed.renderer = name;
    loaded.provide(changed);
  };
}

}  // namespace touchstone::apps
