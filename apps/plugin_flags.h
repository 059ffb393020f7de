// --plugin and what goes with it, the same for every command that takes a model.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/plugin/plugin.h"

namespace touchstone::apps {

struct PluginFlags {
  std::vector<std::string> libraries;
  std::string source;
  bool in_process = false;
  double step_limit_s = 10.0;

  void add_to(CLI::App& command);

  // Where and how the libraries are loaded. Throws UsageError for a limit that makes no sense.
  [[nodiscard]] plugin::PluginOptions options() const;
  // Loads the libraries. Throws as Plugins::load() does, UsageError for a limit that makes no sense.
  [[nodiscard]] plugin::Plugins load() const;
};

// plugin::load_model() beside the catalogue of renderers/.
rendering::Model load_model(const std::filesystem::path& path, const plugin::Plugins& plugins);

}  // namespace touchstone::apps
