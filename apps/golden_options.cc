#include "apps/golden_options.h"

#include "harness/golden/golden_store.h"

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

std::filesystem::path GoldenOptions::folder() const {
  return golden == GoldenOptions{}.golden ? golden::usual_golden_folder(golden) : std::filesystem::path(golden);
}

std::vector<golden::GoldenCase> GoldenOptions::load() const { return golden::choose_cases(folder(), cases); }

std::vector<std::string> GoldenOptions::models_of(const golden::GoldenCase& one) const {
  if (!model.empty()) return {model};
  std::vector<std::string> models;
  for (const auto& [name, ignored] : one.models) models.push_back(name);
  return models;
}

golden::ChangeModel GoldenOptions::change_model() const {
  if (renderer.empty() && plugins.libraries.empty()) return {};
  return [loaded = plugins.load(), name = renderer](rendering::Model& changed) {
    if (!name.empty()) changed.renderer = name;
    loaded.provide(changed);
  };
}

}  // namespace touchstone::apps
