#include "command_experiment_scan.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "experiments/scan_pages.h"
#include "experiments/seeded_experiments.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/recording/recording_file.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/extend_edges.h"
#include "harness/surface/mesh_file.h"
#include "seeded_command.h"

namespace touchstone::studies {
using report::Page;

namespace {

struct ExperimentScanOptions {
  SeededOptions seeded;
  std::uint64_t seed = 1;
  std::size_t seeds = 1;
  std::string recording, mesh;
  double mesh_unit_m = 1.0;
  double block_s = 6.0;
  std::vector<double> extend_m{0.02};
};

void write_report(const ExperimentScanOptions& options, const std::string& name, const std::string& json,
                  const Page& page) {
  const std::filesystem::path out = options.seeded.out;
  write_file(out / (name + ".json"), json);
  write_html(out / "report.html", page);
  write_file(out / "tables.md", tables_to_markdown(page));
  fmt::print("report: {}\n", (out / "report.html").string());
}

ExitStatus run_friction(const ExperimentScanOptions& options) {
  if (options.recording.empty() != options.mesh.empty())
    throw UsageError("--recording and --mesh belong together: a real scan and the surface it was made over");
  const auto seeded = experiments::seeded_friction(options.seed, options.seeds);
  const SeededRun run = run_seeded(seeded, options.seeded, "friction");
  if (run.seeds.empty()) return run.status;
  auto experiment = experiments::friction_from_json(run.seeds.front().result.document);
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(*run.rows);
  if (!options.recording.empty()) {
    Progress progress("friction of a real recording", options.extend_m.size());
    const recording::Recording recording = recording::load_recording(options.recording);
    const surface::TriangleMesh mesh = surface::load_mesh(options.mesh, options.mesh_unit_m);
    for (const double extend_m : options.extend_m) {
      const auto surface = make_embree_surface(extend_m > 0.0 ? extend_open_edges(mesh, extend_m) : mesh);
      experiment.real.push_back(experiments::fit_real_friction(recording, surface, options.block_s));
      experiment.real.back().extended_m = extend_m;
      progress.update(experiment.real.size());
    }
    provenance.inputs.push_back(report::describe_input("recording", options.recording));
    provenance.inputs.push_back(report::describe_input("mesh", options.mesh));
  }
  const auto spread = experiments::stored_spread(seeded, run.seeds);
  fmt::print("{}{}", experiments::friction_table(experiment), experiments::spread_table(spread));
  if (options.seeded.out.empty()) return run.status;
  Page page = experiments::friction_page(experiment, provenance);
  page.sections.insert(page.sections.end() - 1, experiments::spread_section(spread));
  write_report(options, "friction", experiments::friction_to_json(experiment), page);
  return run.status;
}

ExitStatus run_density(const ExperimentScanOptions& options, bool shading) {
  const std::string name = shading ? "shading" : "density";
  const auto seeded = experiments::seeded_density(options.seed, options.seeds, shading);
  const SeededRun run = run_seeded(seeded, options.seeded, name);
  if (run.seeds.empty()) return run.status;
  const auto experiment = experiments::density_from_json(run.seeds.front().result.document);
  const auto spread = experiments::stored_spread(seeded, run.seeds, experiments::density_part(shading));
  fmt::print("{}{}", experiments::density_table(experiment, shading), experiments::spread_table(spread));
  if (options.seeded.out.empty()) return run.status;
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(*run.rows);
  Page page = experiments::density_page(experiment, shading, provenance);
  page.sections.insert(page.sections.begin() + 1, experiments::spread_section(spread));
  write_report(options, name, experiments::density_to_json(experiment), page);
  return run.status;
}

CLI::App* add(CLI::App& experiment, const std::string& name, const std::string& about,
              const std::shared_ptr<ExperimentScanOptions>& options) {
  auto* const command = experiment.add_subcommand(name, about);
  command->add_option("--out", options->seeded.out, "Folder for report.html, tables.md and " + name + ".json");
  command->add_option("--seed", options->seed, "Of the scan")->capture_default_str();
  command->add_option("--seeds", options->seeds, "How many seeds, from --seed on; the tables are of the first")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_seeded_flags(*command, options->seeded, name);
  return command;
}

}  // namespace

void add_scan_experiments(CLI::App& experiment, apps::Run& run) {
  auto friction = std::make_shared<ExperimentScanOptions>();
  auto* const command = add(experiment, "friction",
                            "Friction identified from scans (Ruffaldi et al. 2006, table 2): the coefficient, and the "
                            "error with and without",
                            friction);
  command->add_option("--recording", friction->recording, "A real recording beside the simulated ones (CSV or HDF5)");
  command->add_option("--mesh", friction->mesh, "The surface of zero force of its positions");
  command->add_option("--mesh-unit", friction->mesh_unit_m, "Unit of the mesh")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, double>{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"km", 1e3}}));
  command->add_option("--block", friction->block_s, "Seconds of the blocks that are fitted and held out in turn")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--extend", friction->extend_m,
                   "How far an open mesh is continued at its edges [m], 0 for not at all; several are tried in turn")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->footer(
      "Examples:\n  touchstone experiment friction --seeds 5\n  touchstone experiment friction --out friction "
      "--recording raster.csv --mesh phantom.obj --mesh-unit mm --extend 0,0.005,0.02\n" +
      seeded_examples("friction"));
  command->callback([friction, &run] { run = [friction] { return run_friction(*friction); }; });
  for (const bool shading : {false, true}) {
    auto options = std::make_shared<ExperimentScanOptions>();
    const std::string name = shading ? "shading" : "density";
    auto* const own = add(experiment, name,
                          shading ? "Force shading over the density of the mesh (Ruffaldi et al. 2006, figure 7)"
                                  : "Force error over the density of the mesh (Ruffaldi et al. 2006, table 3)",
                          options);
    own->footer(fmt::format(
        "The rows of `density` are those of `shading`: --cases with the file of the one gives the report of the "
        "other.\n"
        "Examples:\n  touchstone experiment {0}\n  touchstone experiment {0} --out {0} --seed 7 --seeds 5\n{1}",
        name, seeded_examples(name)));
    own->callback([options, shading, &run] { run = [options, shading] { return run_density(*options, shading); }; });
  }
}

}  // namespace touchstone::studies
