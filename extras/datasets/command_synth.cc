#include <fmt/format.h>

#include "dataset_commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/named_values.h"
#include "harness/base/units.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"
#include "listing.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/trajectory_catalogue.h"
#include "write_dataset.h"

namespace touchstone::datasets {
namespace {

struct SynthOptions {
  bool list = false;
  std::string dataset, surface, trajectory;
  std::vector<std::string> parameters;
  std::size_t triangles = 10000;
  double rate_Hz = 1000.0;
  std::uint64_t seed = 1;
  std::string mesh_unit = "m", out, json;
};

ExitStatus synth_command(const SynthOptions& options) {
  if (options.list) {
    fmt::print("{}", catalogue_markdown());
    if (!options.json.empty()) write_file(options.json, catalogue_json());
    return ExitStatus::passed;
  }
  if (options.out.empty()) throw UsageError("--out is needed: the file or, for --dataset, the folder to write");
  const synthetic::ParameterOverrides overrides = named_values("--param", options.parameters);
  if (!options.dataset.empty()) {
    if (!overrides.empty())
      throw UsageError("--param does not go with --dataset: its recipe is fixed, only the seed is free");
    write_dataset(recipe(options.dataset), options.seed, options.out);
    fmt::print("{}: data set {}, seed {}\n", options.out, options.dataset, options.seed);
  } else if (!options.surface.empty()) {
    const double unit_m = length_unit_factor(options.mesh_unit);
    surface::mesh_format(options.out);  // an unknown extension is said before a large mesh is made
    const auto made = synthetic::make_mesh(options.surface, overrides, options.triangles);
    save_mesh(made.mesh, options.out, unit_m);
    fmt::print("{}: {} in {}, {} triangles, no further than {:.6g} m from the surface\n", options.out, made.mesh.source,
               options.mesh_unit, made.mesh.triangle_count(), made.deviation_bound_m);
    if (!options.json.empty()) {
      write_file(options.json,
                 fmt::format("{{\"triangles\": {}, \"vertices\": {}, \"deviation_bound_m\": {}}}\n",
                             made.mesh.triangle_count(), made.mesh.vertices_W_m.size(), made.deviation_bound_m));
    }
  } else {
    const auto path = synthetic::make_path(options.trajectory, overrides, options.seed);
    const recording::InTrajectory trajectory = synthetic::sample(*path, options.rate_Hz);
    save_trajectory(options.out, trajectory);
    fmt::print("{}: {} over {:.6g} s, {} samples at {:.6g} Hz\n", options.out, options.trajectory, path->duration_s(),
               trajectory.size(), options.rate_Hz);
    if (!options.json.empty()) {
      write_file(options.json,
                 fmt::format("{{\"samples\": {}, \"duration_s\": {}}}\n", trajectory.size(), path->duration_s()));
    }
  }
  return ExitStatus::passed;
}

}  // namespace

void add_synth(CLI::App& program, apps::Run& run) {
  auto* const command =
      program.add_subcommand("synth", "Make meshes, trajectories and data sets whose exact answer is known");
  auto options = std::make_shared<SynthOptions>();
  auto* const what = command->add_option_group("what");
  what->add_flag("--list", options->list, "Print every data set, surface and trajectory with its parameters");
  what->add_option("--dataset", options->dataset, "A data set: mesh, recording through instruments, exact answer");
  what->add_option("--surface", options->surface, "A mesh of an analytic surface");
  what->add_option("--trajectory", options->trajectory, "Positions over time");
  what->require_option(1);
  command->add_option("--param", options->parameters, "name=value of the surface or trajectory; may be repeated");
  command->add_option("--triangles", options->triangles, "About how many triangles the mesh has")
      ->capture_default_str();
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the written mesh: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  command->add_option("--rate", options->rate_Hz, "Samples of the trajectory per second")->capture_default_str();
  command->add_option("--seed", options->seed, "Of whatever is random")->capture_default_str();
  command->add_option("--out", options->out,
                      "File to write (mesh: .obj .off .ply .stl; trajectory: .csv .h5; also .gz), or folder");
  command->add_option("--json", options->json, "Write the catalogue or the summary as JSON");
  command->footer(
      "Examples:\n"
      "  touchstone synth --list\n"
      "  touchstone synth --surface torus --param tube_radius_m=0.008 --triangles 20000 --out torus.ply\n"
      "  touchstone synth --surface extrusion --param side_angle_rad=1.2 --param edge_radius_m=0.0005 --mesh-unit mm "
      "--out ridge.obj\n"
      "  touchstone synth --trajectory hand-scan --seed 7 --param reaches=40 --rate 1000 --out in.csv\n"
      "  touchstone synth --dataset plane --seed 1 --out plane/");
  command->callback([options, &run] { run = [options] { return synth_command(*options); }; });
}

}  // namespace touchstone::datasets
