#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/plugin_flags.h"
#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/json_numbers.h"
#include "harness/report/page_html.h"
#include "loop_report.h"
#include "renderers/catalogue.h"
#include "servo/atlas.h"
#include "setup_flags.h"
#include "synthetic/generators.h"

namespace touchstone::loop {
namespace {

struct AtlasOptions {
  SetupFlags setup;
  double stiffness_N_per_m = 500.0;
  std::string out, json;
  apps::PluginFlags plugins;
};

std::string words(const servo::AtlasAnswer& answer) {
  if (!answer.refused.empty()) return "does not run";
  if (answer.verdict == servo::Verdict::buzzes)
    return fmt::format("buzzes {:.0f} Hz, {:.2g} JND", answer.worst.buzz.frequency_Hz, answer.worst.buzz.jnd);
  return std::string(name_of(answer.verdict));
}

std::string to_json(const std::vector<servo::AtlasAnswer>& answers, const servo::LoopSetup& setup, double stiffness) {
  nlohmann::json cells = nlohmann::json::array();
  for (const servo::AtlasAnswer& answer : answers) {
    cells.push_back({{"renderer", answer.renderer},
                     {"case", answer.where},
                     {"verdict", name_of(answer.verdict)},
                     {"buzz_Hz", report::exact_number(answer.worst.buzz.frequency_Hz)},
                     {"buzz_N", report::exact_number(answer.worst.buzz.amplitude_N)},
                     {"buzz_jnd", report::exact_number(answer.worst.buzz.jnd)},
                     {"ideal_servo_jnd", report::exact_number(answer.worst.own.jnd)},
                     {"kick_N", report::exact_number(answer.worst.kick_N)},
                     {"energy_J", report::exact_number(answer.worst.energy_J)},
                     {"refused", answer.refused}});
  }
  const nlohmann::json whole{
      {"schema", "touchstone-loop-atlas/1"}, {"device", setup.device.name}, {"grip", setup.grip.name},
      {"stiffness_N_per_m", stiffness},      {"assumed", setup.assumed},    {"cells", cells}};
  return whole.dump(2) + "\n";
}

report::Page atlas_page(const std::vector<servo::AtlasAnswer>& answers, const servo::LoopSetup& setup,
                        double stiffness) {
  const std::size_t cases = servo::atlas_cases().size();
  std::size_t stable = 0;
  report::Table table;
  table.caption =
      fmt::format("Springs of {:g} N/m where the renderer has that parameter, meshes of 10,000 triangles.", stiffness);
  table.columns = {"renderer"};
  for (const servo::AtlasCase& own : servo::atlas_cases()) table.columns.push_back(own.name);
  for (std::size_t i = 0; i < answers.size(); i += cases) {
    report::Table::Row row;
    row.cells.push_back(report::text_cell(answers[i].renderer));
    for (std::size_t j = i; j < i + cases; ++j) {
      report::Table::Cell cell = report::text_cell(words(answers[j]));
      cell.tone = tone_of(answers[j].verdict);
      stable += answers[j].verdict == servo::Verdict::stable ? 1 : 0;
      row.cells.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  report::Page page;
  page.title = "Which renderer is stable where";
  page.subtitle = fmt::format("{} in a {} grip: {} of {} pairs of a renderer and a shape are stable.",
                              setup.device.name, setup.grip.name, stable, answers.size());
  report::Section section{"Verdicts", "Each shape is pressed with 1 N and slid over along x at 16 mm/s.", {}, false};
  section.blocks.emplace_back(std::move(table));
  page.sections = {section, setup_section(setup), not_modelled_section(),
                   report::provenance_section(report::make_provenance(apps::command_line()))};
  return page;
}

ExitStatus atlas_command(const AtlasOptions& options) {
  const servo::LoopSetup setup = options.setup.make();
  const plugin::Plugins plugins = options.plugins.load();
  std::vector<rendering::Model> models;
  for (const auto& entry : renderers::renderer_catalogue())
    models.push_back(servo::atlas_model(entry, options.stiffness_N_per_m));
  for (const auto& entry : plugins.entries()) {
    models.push_back(servo::atlas_model(*entry, options.stiffness_N_per_m));
    models.back().provided = entry;
  }
  std::vector<servo::AtlasAnswer> answers;
  Progress progress("atlas", models.size() * servo::atlas_cases().size());
  for (const rendering::Model& model : models) {
    for (const servo::AtlasCase& where : servo::atlas_cases()) {
      answers.push_back(servo::atlas_answer(renderers::built_in_catalogue(), synthetic::built_in_generators(), model,
                                            where, setup, {}));
      progress.update(answers.size());
    }
  }
  const std::string result = to_json(answers, setup, options.stiffness_N_per_m);
  if (!options.out.empty()) {
    const std::filesystem::path out = options.out;
    ensure_writable_folder(out);
    write_file(out / "result.json", result);
    write_html(out / "report.html", atlas_page(answers, setup, options.stiffness_N_per_m));
  }
  if (!options.json.empty()) write_file(options.json, result);
  std::vector<std::vector<std::string>> rows{{"renderer", "shape", "in the hand", "ideal servo [JND]", "kick [N]"}};
  for (const servo::AtlasAnswer& answer : answers) {
    rows.push_back({answer.renderer, answer.where, words(answer), fmt::format("{:.2g}", answer.worst.own.jnd),
                    fmt::format("{:.2g}", answer.worst.kick_N)});
  }
  fmt::print("{}", report::align_columns(rows));
  return ExitStatus::passed;
}

}  // namespace

void add_atlas(CLI::App& loop, apps::Run& run) {
  auto* const command = loop.add_subcommand(
      "atlas", "Every renderer over edges, creases, thin walls and friction: which is stable where");
  auto options = std::make_shared<AtlasOptions>();
  options->setup.add_to(*command);
  command->add_option("--stiffness", options->stiffness_N_per_m, "Of the renderers' springs [N/m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for report.html and result.json");
  command->add_option("--json", options->json, "Write the answers as JSON");
  options->plugins.add_to(*command);
  command->footer(
      "Examples:\n"
      "  touchstone loop atlas --device touch --grip light --out a\n"
      "  touchstone loop atlas --device touch-x --grip firm --stiffness 2000 --plugin ./libmine.so --json a.json");
  command->callback([options, &run] { run = [options] { return atlas_command(*options); }; });
}

}  // namespace touchstone::loop
