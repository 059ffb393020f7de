#include "renderers/tool/tool_catalogue.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_topology.h"
#include "renderers/tool/god_object_tool.h"
#include "renderers/tool/penalty_coupling.h"
#include "renderers/tool/voxmap_pointshell.h"

namespace touchstone::renderers {
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

}  // namespace

std::vector<ToolRendererInfo> tool_renderers() {
  return {
      {"god-object-tool", "constraint-based god-object for rigid bodies (Ortega, Redon and Coquillart 2007)"},
      {"voxmap-pointshell", "tangent-plane force of a point shell in voxels (McNeely, Puterbaugh and Troy 1999, 2005)"},
      {"penalty-coupling",
       "penalty forces on a tool with mass behind a virtual coupling (Colgate 1995; Otaduy and Lin 2006)"}};
}

std::unique_ptr<ToolRenderer> make_tool_renderer(std::string_view name, const Tool& tool, const TriangleMesh& object_W,
                                                 const ToolSettings& settings) {
  require_positive(settings.coupling.stiffness_N_per_m, "stiffness of the coupling");
  require_positive(settings.coupling.rotational_stiffness_Nm_per_rad, "rotational stiffness of the coupling");
  require_positive(settings.contact_stiffness_N_per_m, "contact stiffness");
  require_closed(tool.mesh_T, "tool");
  require_closed(object_W, "object");
  if (name == "god-object-tool") return std::make_unique<GodObjectTool>(tool, object_W, settings.coupling);
  if (name == "voxmap-pointshell") {
    return std::make_unique<VoxmapPointshell>(make_point_shell(tool.mesh_T, settings.point_spacing_m),
                                              *make_embree_surface(object_W), settings);
  }
  if (name == "penalty-coupling") {
    return std::make_unique<PenaltyCoupling>(tool, make_point_shell(tool.mesh_T, settings.point_spacing_m),
                                             make_embree_surface(object_W), settings);
  }
  std::string known;
  for (const ToolRendererInfo& info : tool_renderers()) known += (known.empty() ? "" : ", ") + info.name;
  throw UsageError(fmt::format("tool renderer '{}' is not known; known: {}", name, known));
}

ToolSubject tool_subject(std::string_view name, const ToolSettings& settings) {
  // The checks press with up to 3 N.
  constexpr double kPress_N = 3.0;
  ToolSubject subject;
  subject.name = name;
  subject.make = [name = subject.name, settings](const Tool& tool, const TriangleMesh& object_W,
                                                 const Coupling& coupling) {
    ToolSettings with = settings;
    with.coupling = coupling;
    return make_tool_renderer(name, tool, object_W, with);
  };
  if (name == "voxmap-pointshell") {
    subject.resolution_m = settings.voxel_m;
    subject.exact_normals = false;
  }
  if (name == "penalty-coupling") subject.resolution_m = kPress_N / settings.contact_stiffness_N_per_m;
  return subject;
}

}  // namespace touchstone::renderers
