#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/program.h"
#include "atlas/atlas_cases.h"
#include "atlas/atlas_report.h"
#include "case_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"
#include "study_commands.h"

namespace touchstone::studies {
namespace {

struct AtlasOptions {
  atlas::AtlasGrid grid;
  std::string out;
  runs::CaseOptions cases;
};

void write_report(const std::filesystem::path& out, const std::vector<atlas::AtlasCase>& cases,
                  const runs::CaseOutcome& outcome, const runs::CaseOptions& options) {
  write_file(out / "atlas.json", atlas::atlas_to_json(cases));
  write_file(out / "bump.svg", atlas::atlas_picture(cases, atlas::Scene::bump));
  write_file(out / "shell.svg", atlas::atlas_picture(cases, atlas::Scene::shell));
  report::Provenance provenance = report::make_provenance(apps::command_line());
  provenance.inputs.push_back(runs::stored_rows(*outcome.store, options));
  const report::Page page = atlas::atlas_page(cases, provenance);
  write_html(out / "report.html", page);
  write_file(out / "tables.md", tables_to_markdown(page));
  fmt::print("report: {}\n", (out / "report.html").string());
}

ExitStatus run(AtlasOptions options) {
  if (!options.out.empty() && !options.cases.dry_run) ensure_writable_folder(options.out);
  if (options.cases.file.empty() && !options.out.empty())
    options.cases.file = (std::filesystem::path(options.out) / "atlas.sqlite").string();
  atlas::AtlasWorld world(options.grid);
  runs::CaseCommand command;
  command.job = atlas::atlas_job(options.grid, world);
  command.table = atlas::atlas_case_table(options.grid);
  command.words = atlas::atlas_words(options.grid);
  command.describe = [&](std::uint64_t number) { return atlas::describe_case(options.grid, number); };
  const runs::CaseOutcome outcome = run_case_command(command, options.cases);
  if (!outcome.store) return outcome.status;
  const auto cases = atlas::stored_cases(options.grid, *outcome.store);
  fmt::print("{}", atlas::atlas_table(cases));
  if (!options.out.empty()) write_report(options.out, cases, outcome, options.cases);
  return outcome.status;
}

}  // namespace

void add_atlas(CLI::App& program, apps::Run& run_it) {
  auto* const command = program.add_subcommand(
      "atlas", "Map where renderers stick, pop through, lose contact or pull inward: sharpness x stiffness x friction");
  auto options = std::make_shared<AtlasOptions>();
  auto& grid = options->grid;
  command->add_option("--out", options->out, "Folder for report.html, tables.md, atlas.json, bump.svg and shell.svg");
  runs::add_case_file_flags(*command, options->cases, "atlas.sqlite in --out; without either, kept nowhere");
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
  runs::add_case_flags(*command, options->cases, "cases");
  command->footer(
      "A run that stopped goes on where it was; a case that cannot be run is a row with its error and stands as ? in "
      "the "
      "maps.\nExit status 1: cases are missing, or could not be run.\n"
      "Examples:\n"
      "  touchstone atlas --out atlas\n"
      "  touchstone atlas --renderers god-object,penalty --mus 0 --angles 0.5,1.0,1.5\n"
      "  touchstone atlas --cases a.sqlite --shard 1/2   (and b.sqlite with 2/2 on another machine)\n"
      "  touchstone atlas --merge a.sqlite b.sqlite --out atlas\n"
      "  touchstone atlas --out atlas --engine slurm --tasks 20 --slurm-options=--partition=short");
  command->callback([options, &run_it] { run_it = [options] { return run(*options); }; });
}

}  // namespace touchstone::studies
