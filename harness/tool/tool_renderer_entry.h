// What a program knows of a kind of renderer of tools before it makes one: its name, its parameters and how to make it.
// Entries come from extras/tool and from plug-ins (harness/plugin).
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/parameters.h"
#include "harness/surface/triangle_mesh.h"
#include "harness/tool/coupling.h"
#include "harness/tool/tool.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

struct ToolSubject;  // harness/tool/tool_checks.h

struct ToolRendererEntry {
  std::string name;
  std::string summary;                                      // one line
  std::string source;                                       // the publication that the algorithm follows
  std::vector<rendering::ParameterDeclaration> parameters;  // beside the coupling's
  // Both meshes are closed, with outward orientation.
  using Make = std::function<std::unique_ptr<ToolRenderer>(const rendering::Parameters&, const Tool&,
                                                           const surface::TriangleMesh& object_W, const Coupling&)>;
  Make make;
  // How finely the method resolves where the surface is: the voxel, how far a contact's spring gives way under the
  // force, a plug-in's epsilon. Empty: to rounding.
  std::function<double(const rendering::Parameters&, double force_N)> resolution_m;
  // False for a method whose normals are the tool's own (tangent planes at sampled points): at a sharp edge its force
  // is off by more than the resolution.
  bool exact_normals = true;
  bool takes_points = false;           // renders a tool of points alone (Tool::shell)
  std::filesystem::path library = {};  // of a plug-in
};

// Renderers whose method has lengths of its own (margins, overlaps) declare this parameter, and meshes and poses may
// then be in any unit of length, if the coupling and the answer are taken in newtons, that unit and radians.
inline constexpr std::string_view unit_parameter_name = "unit_m";
inline rendering::ParameterDeclaration unit_parameter() {
  return {std::string(unit_parameter_name), "m", 1e-6, 1e6, 1.0, "how long one unit of meshes, poses and coupling is"};
}

// Renderers with Coulomb friction at each contact declare this parameter; the checks of tool_checks.h hold them to it.
inline constexpr std::string_view friction_parameter_name = "mu";
inline rendering::ParameterDeclaration friction_parameter() {
  return {std::string(friction_parameter_name), "1", 0.0, 5.0, 0.0, "Coulomb friction of each contact; 0 without"};
}

// What a user sets of a renderer; parameters that are not named have their initial values.
struct ToolSettings {
  Coupling coupling;
  std::map<std::string, double> parameters;
};

// Of the values that a user gives for several renderers, those that `entry` has. Throws UsageError for one that none of
// `run` has.
std::map<std::string, double> own_values(const std::map<std::string, double, std::less<>>& given,
                                         const ToolRendererEntry& entry, std::span<const ToolRendererEntry> run);

// Throws UsageError for a coupling that is not positive, a parameter that the renderer does not have, a value out of
// range; of a tool
// of points if the renderer needs its mesh; BadData for a mesh that is not closed.
std::unique_ptr<ToolRenderer> make_tool_renderer(const ToolRendererEntry& entry, const Tool& tool,
                                                 const surface::TriangleMesh& object_W, const ToolSettings& settings);

// What holds the renderer to harness/tool/tool_checks.h.
ToolSubject subject_of(const ToolRendererEntry& entry, const ToolSettings& settings);

// Throws UsageError that lists the known names.
const ToolRendererEntry& find_tool_renderer(std::span<const ToolRendererEntry> entries, std::string_view name);

}  // namespace touchstone::tool
