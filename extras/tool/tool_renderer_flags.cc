#include "tool_renderer_flags.h"

#include <filesystem>

#include "harness/base/named_values.h"
#include "harness/base/units.h"
#include "harness/plugin/plugin_tool.h"
#include "harness/surface/mesh_file.h"
#include "tool_points.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool {

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
  std::vector<ToolRendererEntry> out = tool_renderers::tool_renderer_catalogue();
  for (const std::string& library : plugins.libraries) plugin::add_tool_plugin(library, plugins.options(), out);
  return out;
}

ToolSettings ToolRendererFlags::settings_of(const ToolRendererEntry& entry,
                                            std::span<const ToolRendererEntry> run) const {
  return {coupling, own_values(named_values("--parameter", parameters), entry, run)};
}

CLI::Option* ToolShapeFlags::add_to(CLI::App& command) {
  CLI::Option* const shape =
      command.add_option("--tool", file,
                         "The tool in its own frame, origin at the handle: a closed mesh (OBJ, OFF, PLY or STL), or "
                         "points (CSV: x_m, y_m, z_m and the outward normal nx, ny, nz) for renderers that sample");
  command.add_option("--tool-mass", mass_kg, "kg; default: of a mesh filled with water, of points 0.1")
      ->check(CLI::PositiveNumber);
  return shape;
}

Tool ToolShapeFlags::load() const {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".csv" || extension == ".gz" || extension == ".h5" || extension == ".hdf5") {
    constexpr double usual_kg = 0.1;
    return point_tool(load_point_shell(file), mass_kg > 0.0 ? mass_kg : usual_kg);
  }
  const surface::TriangleMesh mesh = surface::load_mesh(file, length_unit_factor(unit));
  const Tool filled = solid_tool(mesh);
  if (!(mass_kg > 0.0)) return filled;
  return solid_tool(mesh, usual_tool_density_kg_per_m3 * mass_kg / filled.mass.mass_kg);
}

}  // namespace touchstone::tool
