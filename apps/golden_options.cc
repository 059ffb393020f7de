#include "apps/golden_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/bundled_files.h"
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

namespace {

// A folder named "golden" may be something else's, such as CMake's for the build of the cases.
bool holds_cases(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (std::filesystem::exists(entry.path() / "case.json", error)) return true;
  }
  return false;
}

}  // namespace

std::filesystem::path GoldenOptions::folder() const {
  if (golden == GoldenOptions{}.golden && !holds_cases(golden)) {
    if (const auto bundled = find_bundled("golden")) return *bundled;
  }
  return golden;
}

std::vector<GoldenCase> GoldenOptions::load() const {
  const std::filesystem::path own = folder();
  if (cases.empty()) return load_cases(own);
  std::vector<GoldenCase> chosen;
  for (const std::string& name : cases) {
    const bool is_folder = name.find('/') != std::string::npos;
    std::filesystem::path path = is_folder ? std::filesystem::path(name) : own / name;
    if (!path.has_filename()) path = path.parent_path();
    if (!std::filesystem::is_directory(path)) {
      std::string known;
      for (const GoldenCase& one : load_cases(own)) known += ' ' + one.name;
      throw UsageError(fmt::format("there is no golden case '{}' in {}; there are:{}", name, own.string(), known));
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
  if (renderer.empty() && plugins.libraries.empty()) return {};
  return [loaded = plugins.load(), name = renderer](Model& changed) {
    if (!name.empty()) changed.renderer = name;
    loaded.provide(changed);
  };
}

}  // namespace touchstone::apps
