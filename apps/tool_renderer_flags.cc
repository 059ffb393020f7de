#include "apps/tool_renderer_flags.h"

#include "harness/base/named_values.h"
#include "harness/plugin/plugin_tool.h"
#include "renderers/tool/tool_catalogue.h"

namespace touchstone::apps {

using tool::ToolRendererEntry;
using tool::ToolSettings;

void ToolRendererFlags::add_to(CLI::App& command) {
  command.add_option("--stiffness", coupling.stiffness_N_per_m, "Of the coupling between hand and tool, N/m")
      ->capture_default_str();
  command.add_option("--rotational-stiffness", coupling.rotational_stiffness_Nm_per_rad, "Of the coupling, Nm/rad")
      ->capture_default_str();
  command.add_option("--parameter", parameters,
                     "NAME=VALUE of a renderer that has it (`touchstone tool list`); may be given several times");
  plugins.add_to(command);
}

std::vector<ToolRendererEntry> ToolRendererFlags::entries() const {
  std::vector<ToolRendererEntry> out = renderers::tool_renderer_catalogue();
  for (const std::string& library : plugins.libraries) add_tool_plugin(library, plugins.options(), out);
  return out;
}

ToolSettings ToolRendererFlags::settings_of(const ToolRendererEntry& entry,
                                            std::span<const ToolRendererEntry> run) const {
  return {coupling, tool::own_values(named_values("--parameter", parameters), entry, run)};
}

}  // namespace touchstone::apps
