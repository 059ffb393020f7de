#include "apps/mesh_flags.h"

#include <fmt/format.h>

#include <utility>

#include "harness/base/units.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_repair.h"
#include "harness/surface/mesh_warnings.h"

namespace touchstone::apps {
using surface::TriangleMesh;

void MeshFlags::add_repair_to(CLI::App& command) {
  command.add_flag("--repair", repair,
                   "Join open edges that lie within a thousandth of the mesh's size, and turn triangles that face the "
                   "other way than most of their piece, and closed pieces that are inside out; says how many");
}

void MeshFlags::add_weld_to(CLI::App& command) {
  command.add_option("--weld", weld,
                     "Close the seams of open sheets that meet with a step or a gap of up to this, such as 0.01mm: "
                     "corners along open edges are joined, and triangles split where a corner lies on their edge");
}

void MeshFlags::add_two_sided_to(CLI::App& command) {
  command.add_flag("--two-sided", two_sided,
                   "Triangles stop the tip from both sides (god-object, friction-cone, force-shading): for sheets that "
                   "are touched from below, too, and for meshes without orientation. A run starts in free space");
}

TriangleMesh MeshFlags::load(const std::string& path, const std::string& unit) const {
  TriangleMesh mesh = surface::load_mesh(path, length_unit_factor(unit));
  for (const std::string& note : reading_notes(mesh)) fmt::print(stderr, "note: {}\n", note);
  repair_if_wanted(mesh);
  return mesh;
}

void MeshFlags::repair_if_wanted(TriangleMesh& mesh) const {
  if (!weld.empty()) {
    surface::OrientedMesh welded = weld_seams(mesh, parse_length_m(weld, "--weld"));
    fmt::print(stderr, "{}\n",
               welded.joined + welded.split > 0
                   ? repair_note(welded)
                   : fmt::format("{}: no corners of open edges lie within {}", mesh.source, weld));
    mesh = std::move(welded.mesh);
  }
  if (!repair) return;
  surface::OrientedMesh repaired = orient(mesh);
  if (const std::string note = repair_note(repaired); !note.empty()) fmt::print(stderr, "{}\n", note);
  mesh = std::move(repaired.mesh);
}

std::shared_ptr<const surface::Surface> MeshFlags::surface(const TriangleMesh& mesh) const {
  return make_embree_surface(two_sided ? surface::two_sided(mesh) : mesh);
}

void MeshFlags::warn(const TriangleMesh& mesh, const surface::Surface& surface) const {
  // Of two sides each is the other one's double.
  const auto warnings = two_sided ? mesh_warnings(*make_embree_surface(mesh)) : mesh_warnings(surface);
  for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
}

}  // namespace touchstone::apps
