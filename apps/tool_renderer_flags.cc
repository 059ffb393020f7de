#include "apps/tool_renderer_flags.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/named_values.h"
#include "harness/base/error.h"
#include "harness/base/known_names.h"
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
  const PluginOptions options = plugins.options();
  for (const std::string& library : plugins.libraries) {
    for (ToolRendererEntry& entry : load_tool_plugin(library, options)) {
      if (std::ranges::find(out, entry.name, &ToolRendererEntry::name) != out.end()) {
        throw BadData(fmt::format("{}: there is a renderer named {} already; give the plug-in's a name of its own",
                                  library, entry.name));
      }
      out.push_back(std::move(entry));
    }
  }
  return out;
}

ToolSettings ToolRendererFlags::settings_of(const ToolRendererEntry& entry,
                                            std::span<const ToolRendererEntry> run) const {
  ToolSettings out{coupling, {}};
  std::vector<std::string> known;
  for (const ToolRendererEntry& one : run) {
    for (const ParameterDeclaration& declared : one.parameters) known.push_back(declared.name);
  }
  for (const auto& [name, value] : named_values("--parameter", parameters)) {
    if (std::ranges::find(known, name) == known.end()) {
      throw UsageError("--parameter: " + unknown_name("parameter", name, known));
    }
    const bool has = std::ranges::find(entry.parameters, name, &ParameterDeclaration::name) != entry.parameters.end();
    if (has) out.parameters[name] = value;
  }
  return out;
}

}  // namespace touchstone::apps
