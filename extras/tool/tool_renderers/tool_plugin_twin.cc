// The catalogue's own renderers of tools as a plug-in, under names of their own: what goes through the plug-in
// interface must come out as it does without.
#include "harness/plugin/tool_export.h"
#include "tool_renderers/god_object_tool.h"
#include "tool_renderers/penalty_coupling.h"

namespace {

touchstone::tool::ToolRendererEntry twin(touchstone::tool::ToolRendererEntry entry) {
  entry.name += "-twin";
  return entry;
}

}  // namespace

TOUCHSTONE_EXPORT_TOOL_RENDERERS(twin(touchstone::tool_renderers::god_object_tool_entry()),
                                 twin(touchstone::tool_renderers::penalty_coupling_entry()));
