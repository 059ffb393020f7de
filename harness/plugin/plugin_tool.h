// A plug-in's renderers of tools with a shape (<touchstone/plugin2.h>, tip_kind TOUCHSTONE2_TOOL) as entries like those
// of extras/tool.
#pragma once

#include <filesystem>
#include <vector>

#include "harness/plugin/loaded_plugin.h"
#include "harness/tool/tool_renderer_entry.h"

namespace touchstone::plugin {

// Throws as LoadedPlugin does; a library without such renderers gives none.
std::vector<tool::ToolRendererEntry> load_tool_plugin(const std::filesystem::path& library,
                                                      const PluginOptions& options);

// Adds the library's to `entries`. Throws as above, and BadData for a name that is taken.
void add_tool_plugin(const std::filesystem::path& library, const PluginOptions& options,
                     std::vector<tool::ToolRendererEntry>& entries);

}  // namespace touchstone::plugin
