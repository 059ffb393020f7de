#include "harness/pipeline/discrepancy/earlier_run.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "harness/base/error.h"
#include "harness/base/input_files.h"

namespace touchstone::pipeline {
namespace {

// "a.json" of a string at the pointer; of anything else, or of what leads out of the folder, nothing.
std::string name_at(const nlohmann::json& root, const nlohmann::json::json_pointer& place) {
  if (!root.contains(place) || !root.at(place).is_string()) return "";
  const std::filesystem::path name = root.at(place).get<std::string>();
  return name.filename() == name && name.has_stem() ? name.string() : "";
}

}  // namespace

EarlierRun::EarlierRun(const std::filesystem::path& folder) {
  const std::filesystem::path findings = folder / "findings.json";
  if (!std::filesystem::is_regular_file(findings)) return;
  // Not by read_file(), to which it would be an input, and this run writes its own there.
  std::ifstream text(findings);
  const auto root = nlohmann::json::parse(text, nullptr, false);
  if (!root.is_object() || !root.contains("schema") || root.at("schema") != "touchstone-findings/1") return;
  using Pointer = nlohmann::json::json_pointer;
  std::vector<std::string> names{name_at(root, Pointer("/next_experiment/trajectory")),
                                 name_at(root, Pointer("/suggested_instrument"))};
  const Pointer pieces("/empirical_law/pieces");
  if (root.contains(pieces) && root.at(pieces).is_array()) {
    names.emplace_back("empirical.json");
    for (std::size_t i = 0; i < root.at(pieces).size(); ++i)
      names.push_back(name_at(root, pieces / std::to_string(i) / "file"));
  }
  for (const std::string& name : names) {
    if (name.empty()) continue;
    refuse_to_replace_input(folder / name);
    files_.push_back(folder / name);
  }
}

void EarlierRun::remove() const {
  for (const auto& file : files_) {
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) {
      throw BadData(
          fmt::format("{}: this file of an earlier run cannot be removed: {}; write into another folder "
                      "with --out",
                      file.string(), error.message()));
    }
  }
}

}  // namespace touchstone::pipeline
