// --repair, --weld and --two-sided, and what is said of a mesh before it is rendered: the same for every command that
// reads one.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "harness/surface/surface.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::apps {

struct MeshFlags {
  bool repair = false;
  std::string weld;  // length with its unit; empty: no seams are closed
  bool two_sided = false;

  void add_repair_to(CLI::App& command);
  void add_weld_to(CLI::App& command);
  void add_two_sided_to(CLI::App& command);

  // The file's mesh, repaired where that is asked for; says on stderr what was done. Throws as load_mesh(),
  // weld_seams() and orient() do.
  [[nodiscard]] surface::TriangleMesh load(const std::string& path, const std::string& unit) const;
  // The same for a mesh that was read already.
  void repair_if_wanted(surface::TriangleMesh& mesh) const;
  // The surface to render.
  [[nodiscard]] std::shared_ptr<const surface::Surface> surface(const surface::TriangleMesh& mesh) const;
  // Says on stderr what is wrong with the mesh, a line each (harness/surface/mesh_warnings.h). `surface` is the answer
  // of surface().
  void warn(const surface::TriangleMesh& mesh, const surface::Surface& surface) const;
};

}  // namespace touchstone::apps
