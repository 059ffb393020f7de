#include "harness/tool/tool_renderer_entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/rendering/unit_dimension.h"
#include "harness/surface/mesh_topology.h"
#include "harness/tool/tool_checks.h"

namespace touchstone::tool {
using rendering::ParameterDeclaration;
using rendering::Parameters;
using surface::TriangleMesh;

namespace {

void require_closed(const TriangleMesh& mesh, std::string_view what) {
  if (mesh.triangles.empty() || !make_topology(mesh).closed()) {
    throw BadData(
        fmt::format("{}: the {}'s mesh is not closed: inside and outside are not known; see `touchstone doctor`",
                    mesh.source, what));
  }
}

void require_positive(double value, std::string_view name) {
  if (!(value > 0.0)) throw UsageError(fmt::format("{}: {}; more than 0 was expected", name, value));
}

Parameters checked(const ToolRendererEntry& entry, const ToolSettings& settings) {
  require_positive(settings.coupling.stiffness_N_per_m, "stiffness of the coupling");
  require_positive(settings.coupling.rotational_stiffness_Nm_per_rad, "rotational stiffness of the coupling");
  try {
    return {entry.parameters, settings.parameters, "renderer " + entry.name, "the options", ""};
  } catch (const BadData& wrong) {
    // They come from the command line, not from a file.
    throw UsageError(wrong.what());
  }
}

// What a parameter's number becomes where lengths are counted in `unit_m`, and newtons and seconds stay: by the power
// of the metre in its own unit. Nothing for a unit that is not known.
std::optional<double> in_unit(const ParameterDeclaration& declared, double value, double unit_m) {
  if (declared.name == unit_parameter_name) return value * unit_m;
  const auto dimension = rendering::dimension_of(declared.unit);
  if (!dimension) return std::nullopt;
  return value * std::pow(unit_m, -dimension->powers[rendering::UnitDimension::metre]);
}

std::string why_only_in_metres(const ToolRendererEntry& entry, const Parameters& parameters) {
  for (const ParameterDeclaration& declared : entry.parameters) {
    for (const double unit_m : other_units_m) {
      const auto value = in_unit(declared, parameters.at(declared.name), unit_m);
      if (!value)
        return fmt::format("what its parameter {} [{}] is in another unit of length is not known; known are {}",
                           declared.name, declared.unit, rendering::known_base_units());
      if (*value < declared.minimum || *value > declared.maximum)
        return fmt::format(
            "its parameter {} would be {:g} where lengths are in units of {:g} m; {:g} to {:g} are taken",
            declared.name, *value, unit_m, declared.minimum, declared.maximum);
    }
  }
  return {};
}

}  // namespace

std::map<std::string, double> own_values(const std::map<std::string, double, std::less<>>& given,
                                         const ToolRendererEntry& entry, std::span<const ToolRendererEntry> run) {
  std::vector<std::string> known;
  for (const ToolRendererEntry& one : run) {
    for (const ParameterDeclaration& declared : one.parameters) known.push_back(declared.name);
  }
  std::map<std::string, double> own;
  for (const auto& [name, value] : given) {
    if (std::ranges::find(known, name) == known.end())
      throw UsageError("--parameter: " + unknown_name("parameter", name, known));
    if (std::ranges::find(entry.parameters, name, &ParameterDeclaration::name) != entry.parameters.end())
      own[name] = value;
  }
  return own;
}

std::unique_ptr<ToolRenderer> make_tool_renderer(const ToolRendererEntry& entry, const Tool& tool,
                                                 const TriangleMesh& object_W, const ToolSettings& settings) {
  const Parameters parameters = checked(entry, settings);
  if (!tool.shell) require_closed(tool.mesh_T, "tool");
  if (tool.shell && !entry.takes_points) {
    throw UsageError(
        fmt::format("renderer {}: needs the tool's mesh, and the tool is given by {} points; take voxmap-pointshell or "
                    "penalty-coupling",
                    entry.name, tool.shell->size()));
  }
  require_closed(object_W, "object");
  return entry.make(parameters, tool, object_W, settings.coupling);
}

ToolSubject subject_of(const ToolRendererEntry& entry, const ToolSettings& settings) {
  // The checks press with up to 3 N.
  constexpr double press_N = 3.0;
  const Parameters parameters = checked(entry, settings);
  ToolSubject subject;
  subject.name = entry.name;
  subject.exact_normals = entry.exact_normals;
  const auto mu = parameters.values().find(friction_parameter_name);
  if (mu != parameters.values().end()) subject.mu = mu->second;
  subject.only_in_metres = why_only_in_metres(entry, parameters);
  if (entry.resolution_m) subject.resolution_m = entry.resolution_m(parameters, press_N);
  subject.make = [entry, settings](const Tool& tool, const TriangleMesh& object_W, const Coupling& coupling) {
    ToolSettings with = settings;
    with.coupling = coupling;
    return make_tool_renderer(entry, tool, object_W, with);
  };
  subject.make_in_unit = [entry, parameters](const Tool& tool, const TriangleMesh& object_W, const Coupling& coupling,
                                             double unit_m) {
    ToolSettings with{coupling, {}};
    for (const ParameterDeclaration& declared : entry.parameters) {
      const auto value = in_unit(declared, parameters.at(declared.name), unit_m);
      if (value) with.parameters[declared.name] = *value;
    }
    return make_tool_renderer(entry, tool, object_W, with);
  };
  return subject;
}

const ToolRendererEntry& find_tool_renderer(std::span<const ToolRendererEntry> entries, std::string_view name) {
  const auto found = std::ranges::find(entries, name, &ToolRendererEntry::name);
  if (found != entries.end()) return *found;
  std::vector<std::string> known;
  for (const ToolRendererEntry& entry : entries) known.push_back(entry.name);
  throw UsageError(unknown_name("tool renderer", name, known));
}

}  // namespace touchstone::tool
