// Where golden cases and what their failures leave behind are found, the same for every command that touches them.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/plugin_flags.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/golden_case.h"

namespace touchstone::apps {

struct GoldenOptions {
  std::string golden = "golden";
  std::string out = "build/golden-failures";
  std::vector<std::string> cases;
  std::string model;
  std::string renderer;
  PluginFlags plugins;

  void add_to(CLI::App& command);
  // The chosen cases (all where none is named); throws UsageError listing the known ones.
  [[nodiscard]] std::vector<golden::GoldenCase> load() const;
  // --golden; if it is not given and no folder of that name with a case in it is here, the cases that come with the
  // program.
  [[nodiscard]] std::filesystem::path folder() const;
  // The chosen models of a case.
  [[nodiscard]] std::vector<std::string> models_of(const golden::GoldenCase& one) const;
  // What the options make of a case's model: its renderer from a plug-in, or another renderer in its place; empty
  // where they leave it as it is.
  [[nodiscard]] golden::ChangeModel change_model() const;
};

}  // namespace touchstone::apps
