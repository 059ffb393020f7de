#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/atlas/atlas_report.h"
#include "apps/commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"

namespace touchstone::apps {
namespace {

struct AtlasOptions {
  atlas::AtlasGrid grid;
  std::string out;
};

ExitStatus run(const AtlasOptions& options) {
  if (!options.out.empty()) ensure_writable_folder(options.out);
  Progress progress("atlas", atlas::case_count(options.grid));
  const auto cases = atlas::run_atlas(options.grid, [&progress](std::size_t done) { progress.update(done); });
  fmt::print("{}", atlas::atlas_table(cases));
  if (options.out.empty()) return ExitStatus::passed;
  const std::filesystem::path out = options.out;
  write_file(out / "atlas.json", atlas::atlas_to_json(cases));
  write_file(out / "bump.svg", atlas::atlas_picture(cases, atlas::Scene::bump));
  write_file(out / "shell.svg", atlas::atlas_picture(cases, atlas::Scene::shell));
  const Page page = atlas::atlas_page(cases, make_provenance(command_line()));
  write_html(out / "report.html", page);
  write_file(out / "tables.md", tables_to_markdown(page));
  fmt::print("report: {}\n", (out / "report.html").string());
  return ExitStatus::passed;
}

}  // namespace

void add_atlas(CLI::App& program, Run& run_it) {
  auto* const command = program.add_subcommand(
      "atlas", "Map where renderers stick, pop through, lose contact or pull inward: sharpness x stiffness x friction");
  auto options = std::make_shared<AtlasOptions>();
  auto& grid = options->grid;
  command->add_option("--out", options->out, "Folder for report.html, tables.md, atlas.json, bump.svg and shell.svg");
  command->add_option("--renderers", grid.renderers, "Names of the catalogue")->delimiter(',')->capture_default_str();
  command->add_option("--angles", grid.side_angles_rad, "Sides of the bump against its block [rad]")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 1.57));
  command->add_option("--thicknesses", grid.thicknesses_m, "Of the shell [m]")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 1e-2));
  command->add_option("--stiffnesses", grid.stiffnesses_N_per_m, "[N/m]")->delimiter(',')->check(CLI::Range(1.0, 1e7));
  command->add_option("--mus", grid.mus, "Friction coefficients")->delimiter(',')->check(CLI::Range(0.0, 5.0));
  command->add_option("--force", grid.force_N, "With which the hand presses [N]")
      ->check(CLI::Range(1e-3, 1e3))
      ->capture_default_str();
  command->footer(
      "Examples:\n  touchstone atlas --out atlas\n  touchstone atlas --renderers god-object,penalty --mus 0 --angles "
      "0.5,1.0,1.5");
  command->callback([options, &run_it] { run_it = [options] { return run(*options); }; });
}

}  // namespace touchstone::apps
