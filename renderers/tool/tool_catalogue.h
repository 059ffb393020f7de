// The renderers of tools with a shape, by name.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "harness/tool/coupling.h"
#include "harness/tool/tool.h"
#include "harness/tool/tool_checks.h"
#include "harness/tool/tool_renderer.h"
#include "renderers/tool/sphere_tree.h"

namespace touchstone::renderers {

// Those that a renderer does not know it ignores.
struct ToolSettings {
  Coupling coupling;
  double contact_stiffness_N_per_m = 20000.0;  // per point: voxmap-pointshell, penalty-coupling
  double voxel_m = 0.5e-3;                     // voxmap-pointshell
  double point_spacing_m = 1e-3;               // of the point shell: voxmap-pointshell, penalty-coupling
};

struct ToolRendererInfo {
  std::string name;
  std::string what;  // one line with its source
};
std::vector<ToolRendererInfo> tool_renderers();

// Both meshes closed, with outward orientation. Throws UsageError for a name that is not known or a setting out of
// range, BadData for a mesh that is not closed.
std::unique_ptr<ToolRenderer> make_tool_renderer(std::string_view name, const Tool& tool, const TriangleMesh& object_W,
                                                 const ToolSettings& settings);

// What holds a renderer of this catalogue to tool_checks.h: how finely it resolves follows from the settings.
ToolSubject tool_subject(std::string_view name, const ToolSettings& settings);

}  // namespace touchstone::renderers
