#include "apps/command_experiment_scan.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "apps/experiments/scan_pages.h"
#include "apps/experiments/seed_spread.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/recording/recording_file.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/extend_edges.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::apps {
namespace {

struct Options {
  std::string out;
  std::uint64_t seed = 1;
  std::size_t seeds = 1;
  std::string recording, mesh;
  double mesh_unit_m = 1.0;
  double block_s = 6.0;
  std::vector<double> extend_m{0.02};
};

void write_report(const Options& options, const std::string& name, const std::string& json, const Page& page) {
  const std::filesystem::path out = options.out;
  write_file(out / (name + ".json"), json);
  write_html(out / "report.html", page);
  write_file(out / "tables.md", tables_to_markdown(page));
  fmt::print("report: {}\n", (out / "report.html").string());
}

ExitStatus run_friction(const Options& options) {
  if (options.recording.empty() != options.mesh.empty())
    throw UsageError("--recording and --mesh belong together: a real scan and the surface it was made over");
  if (!options.out.empty()) ensure_writable_folder(options.out);
  constexpr std::array kCoefficients{0.25, 0.15, 0.40};
  const std::size_t extensions = options.recording.empty() ? 0 : options.extend_m.size();
  Progress progress("friction experiment", kCoefficients.size() * options.seeds + extensions);
  std::size_t done = 0;
  experiments::FrictionExperiment experiment;
  experiments::SeedSpread spread;
  for (std::size_t s = 0; s < options.seeds; ++s) {
    experiments::FrictionExperiment own;
    std::vector<std::pair<std::string, double>> values;
    for (std::size_t i = 0; i < kCoefficients.size(); ++i) {
      own.fits.push_back(experiments::fit_friction(options.seed + kCoefficients.size() * s + i, kCoefficients[i]));
      for (const auto* const probe : {&own.fits.back().soft, &own.fits.back().stiff}) {
        const std::string what =
            fmt::format("mu {:.2f}, probe of {:.0f} N/m: ", kCoefficients[i], probe->stiffness_N_per_m);
        values.emplace_back(what + "fitted mu", probe->fitted_mu);
        values.emplace_back(what + "without [N]", probe->without.mean_N);
        values.emplace_back(what + "with [N]", probe->with.mean_N);
      }
      progress.update(++done);
    }
    std::vector<std::pair<std::string, bool>> findings;
    for (const auto& finding : experiments::friction_findings(own))
      findings.emplace_back(finding.statement, finding.holds);
    spread.add(values, findings);
    if (s == 0) experiment = std::move(own);
  }
  Provenance provenance = make_provenance(command_line());
  if (!options.recording.empty()) {
    const Recording recording = load_recording(options.recording);
    const TriangleMesh mesh = load_mesh(options.mesh, options.mesh_unit_m);
    for (const double extend_m : options.extend_m) {
      const auto surface = make_embree_surface(extend_m > 0.0 ? extend_open_edges(mesh, extend_m) : mesh);
      experiment.real.push_back(experiments::fit_real_friction(recording, surface, options.block_s));
      experiment.real.back().extended_m = extend_m;
      progress.update(++done);
    }
    provenance.inputs.push_back(describe_input("recording", options.recording));
    provenance.inputs.push_back(describe_input("mesh", options.mesh));
  }
  fmt::print("{}{}", experiments::friction_table(experiment), experiments::spread_table(spread));
  if (options.out.empty()) return ExitStatus::passed;
  Page page = experiments::friction_page(experiment, provenance);
  page.sections.insert(page.sections.end() - 1, experiments::spread_section(spread));
  write_report(options, "friction", experiments::friction_to_json(experiment), page);
  return ExitStatus::passed;
}

ExitStatus run_density(const Options& options, bool shading) {
  if (!options.out.empty()) ensure_writable_folder(options.out);
  experiments::DensityExperiment experiment;
  experiments::SeedSpread spread;
  Progress progress(shading ? "shading experiment" : "density experiment", options.seeds);
  for (std::size_t s = 0; s < options.seeds; ++s) {
    auto own = experiments::run_density_experiment(options.seed + s);
    std::vector<std::pair<std::string, double>> values;
    for (const auto& point : own.points) {
      values.emplace_back(fmt::format("{} triangles: proxy [N]", point.triangles), point.plain.mean_N);
      if (shading)
        values.emplace_back(fmt::format("{} triangles: with shading [N]", point.triangles), point.shaded.mean_N);
    }
    std::vector<std::pair<std::string, bool>> findings;
    for (const auto& finding : shading ? experiments::shading_findings(own) : experiments::density_findings(own))
      findings.emplace_back(finding.statement, finding.holds);
    spread.add(values, findings);
    if (s == 0) experiment = std::move(own);
    progress.update(s + 1);
  }
  fmt::print("{}{}", experiments::density_table(experiment, shading), experiments::spread_table(spread));
  if (options.out.empty()) return ExitStatus::passed;
  Page page = experiments::density_page(experiment, shading, make_provenance(command_line()));
  page.sections.insert(page.sections.begin() + 1, experiments::spread_section(spread));
  write_report(options, shading ? "shading" : "density", experiments::density_to_json(experiment), page);
  return ExitStatus::passed;
}

CLI::App* add(CLI::App& experiment, const std::string& name, const std::string& about,
              const std::shared_ptr<Options>& options) {
  auto* const command = experiment.add_subcommand(name, about);
  command->add_option("--out", options->out, "Folder for report.html, tables.md and " + name + ".json");
  command->add_option("--seed", options->seed, "Of the scan")->capture_default_str();
  command->add_option("--seeds", options->seeds, "How many seeds, from --seed on; the tables are of the first")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  return command;
}

}  // namespace

void add_scan_experiments(CLI::App& experiment, Run& run) {
  auto friction = std::make_shared<Options>();
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
      "--recording raster.csv --mesh phantom.obj --mesh-unit mm --extend 0,0.005,0.02");
  command->callback([friction, &run] { run = [friction] { return run_friction(*friction); }; });
  for (const bool shading : {false, true}) {
    auto options = std::make_shared<Options>();
    const std::string name = shading ? "shading" : "density";
    auto* const own = add(experiment, name,
                          shading ? "Force shading over the density of the mesh (Ruffaldi et al. 2006, figure 7)"
                                  : "Force error over the density of the mesh (Ruffaldi et al. 2006, table 3)",
                          options);
    own->footer(fmt::format(
        "Examples:\n  touchstone experiment {0}\n  touchstone experiment {0} --out {0} --seed 7 --seeds 5", name));
    own->callback([options, shading, &run] { run = [options, shading] { return run_density(*options, shading); }; });
  }
}

}  // namespace touchstone::apps
