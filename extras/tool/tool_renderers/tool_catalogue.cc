#include "tool_renderers/tool_catalogue.h"

#include "tool_renderers/god_object_tool.h"
#include "tool_renderers/penalty_coupling.h"
#include "tool_renderers/voxmap_pointshell.h"

namespace touchstone::tool_renderers {

const std::vector<tool::ToolRendererEntry>& tool_renderer_catalogue() {
  static const std::vector<tool::ToolRendererEntry> catalogue{
      god_object_tool_entry(),
      voxmap_pointshell_entry(),
      penalty_coupling_entry(),
  };
  return catalogue;
}

std::unique_ptr<tool::ToolRenderer> make_tool_renderer(std::string_view name, const tool::Tool& tool,
                                                       const surface::TriangleMesh& object_W,
                                                       const tool::ToolSettings& settings) {
  return tool::make_tool_renderer(find_tool_renderer(tool_renderer_catalogue(), name), tool, object_W, settings);
}

}  // namespace touchstone::tool_renderers
