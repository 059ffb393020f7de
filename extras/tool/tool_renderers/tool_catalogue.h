// The renderers of tools with a shape that this program has: a new one is a file pair and one line in the .cc.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "harness/tool/tool_renderer_entry.h"

namespace touchstone::tool_renderers {

const std::vector<tool::ToolRendererEntry>& tool_renderer_catalogue();

// tool::make_tool_renderer() of a renderer of this catalogue. Throws UsageError for a name that is not known.
std::unique_ptr<tool::ToolRenderer> make_tool_renderer(std::string_view name, const tool::Tool& tool,
                                                       const surface::TriangleMesh& object_W,
                                                       const tool::ToolSettings& settings);

}  // namespace touchstone::tool_renderers
