#include <fmt/format.h>

#include <memory>

#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/units.h"
#include "harness/surface/cgal/self_intersection.h"
#include "harness/surface/mesh_doctor.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::apps {
namespace {

struct DoctorOptions {
  std::string mesh, mesh_unit = "m", json;
  surface::MeshDoctorRule rule;
};

ExitStatus doctor_command(const DoctorOptions& options) {
  const surface::TriangleMesh mesh = surface::load_mesh(options.mesh, length_unit_factor(options.mesh_unit));
  const surface::MeshDiagnosis diagnosis = examine_mesh(mesh, options.rule, surface::self_intersections);
  if (!options.json.empty()) write_file(options.json, diagnosis_json(diagnosis, options.mesh));
  fmt::print("{}", diagnosis_text(diagnosis, options.mesh));
  return diagnosis.sound() ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_doctor(CLI::App& program, Run& run) {
  auto* const command =
      program.add_subcommand("doctor", "Say what is wrong with a mesh and what that means for rendering");
  auto options = std::make_shared<DoctorOptions>();
  command->add_option("MESH,--mesh", options->mesh, "OBJ, OFF, PLY or STL, also .gz")->required();
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  command->add_flag("--sheet", options->rule.sheet,
                    "The mesh is meant to be open (a height field, a sheet): open edges are only noted");
  command->add_option("--list", options->rule.largest_listed, "List this many places of each finding")
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the diagnosis as JSON (touchstone-mesh-diagnosis/1)");
  command->footer(
      "Exit status: 0 nothing that matters, 1 findings that matter to rendering, 3 the mesh cannot be read.\n"
      "Examples:\n"
      "  touchstone doctor scan.stl --mesh-unit mm\n"
      "  touchstone doctor height-field.obj --sheet --json diagnosis.json");
  command->callback([options, &run] { run = [options] { return doctor_command(*options); }; });
}

}  // namespace touchstone::apps
