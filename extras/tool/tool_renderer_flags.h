// The renderers of tools that a command may run, the program's own and those of plug-ins, and what is set of them.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <string>
#include <vector>

#include "apps/plugin_flags.h"
#include "harness/tool/tool_renderer_entry.h"

namespace touchstone::tool {

struct ToolRendererFlags {
  Coupling coupling;
  std::vector<std::string> parameters;  // NAME=VALUE
  apps::PluginFlags plugins;

  void add_to(CLI::App& command);

  // Throws as LoadedPlugin does, and BadData for a name that is taken.
  [[nodiscard]] std::vector<ToolRendererEntry> entries() const;

  // What is set of `entry`, of the parameters that it has. Throws UsageError for a parameter that none of `run` has.
  [[nodiscard]] ToolSettings settings_of(const ToolRendererEntry& entry, std::span<const ToolRendererEntry> run) const;
};

// The tool of a command that takes its shape from a file.
struct ToolShapeFlags {
  std::string file, unit = "m";
  double mass_kg = 0.0;  // 0: that of the shape

  // --tool, which is returned, and --tool-mass; `unit` is set by the command's own flag, which also is the object's.
  CLI::Option* add_to(CLI::App& command);

  // A mesh filled with water, or with what makes the mass that is given; or a table of points (tool_points.h). Throws
  // BadData for a file that is neither.
  [[nodiscard]] Tool load() const;
};

}  // namespace touchstone::tool
