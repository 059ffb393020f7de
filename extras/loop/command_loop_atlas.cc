#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/plugin_flags.h"
#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/known_names.h"
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
  std::vector<std::string> renderers, cases, allowed;
  std::string out, json;
  apps::PluginFlags plugins;
};

// One renderer's row.
struct Judged {
  std::string renderer;
  std::vector<servo::AtlasAnswer> answers;  // by case
  std::vector<servo::AtlasFinding> findings;
};

std::string words(const servo::AtlasAnswer& answer) {
  if (answer.worst.too_slow) return "too slow";
  if (!answer.refused.empty()) return "does not run";
  if (answer.verdict == servo::Verdict::buzzes)
    return fmt::format("buzzes {:.0f} Hz, {:.2g} JND", answer.worst.buzz.frequency_Hz, answer.worst.buzz.jnd);
  return std::string(name_of(answer.verdict));
}

std::string words(const servo::AtlasFinding& finding) {
  std::string out = fmt::format("{}: {:.2g} JND on {}", finding.name, finding.jnd, fmt::join(finding.where, ", "));
  if (!finding.follows_from.empty()) out += fmt::format(" (follows from {})", finding.follows_from);
  return out;
}

// It or its cause.
bool is_allowed(const AtlasOptions& options, const servo::AtlasFinding& finding) {
  return std::ranges::any_of(
      options.allowed, [&](const std::string& name) { return name == finding.name || name == finding.follows_from; });
}

std::string to_json(const std::vector<Judged>& all, const servo::LoopSetup& setup, const AtlasOptions& options) {
  nlohmann::json cells = nlohmann::json::array(), findings = nlohmann::json::array();
  for (const Judged& judged : all) {
    for (const servo::AtlasAnswer& answer : judged.answers) {
      cells.push_back({{"renderer", answer.renderer},
                       {"case", answer.where},
                       {"verdict", name_of(answer.verdict)},
                       {"buzz_Hz", report::exact_number(answer.worst.buzz.frequency_Hz)},
                       {"buzz_N", report::exact_number(answer.worst.buzz.amplitude_N)},
                       {"buzz_jnd", report::exact_number(answer.worst.buzz.jnd)},
                       {"ideal_servo_jnd", report::exact_number(answer.worst.own.jnd)},
                       {"kick_N", report::exact_number(answer.worst.kick_N)},
                       {"kick_jnd", report::exact_number(answer.worst.kick_jnd)},
                       {"energy_J", report::exact_number(answer.worst.energy_J)},
                       {"real_time_factor", report::exact_number(answer.worst.real_time_factor)},
                       {"refused", answer.refused}});
    }
    for (const servo::AtlasFinding& finding : judged.findings) {
      findings.push_back({{"renderer", judged.renderer},
                          {"name", finding.name},
                          {"cases", finding.where},
                          {"jnd", report::exact_number(finding.jnd)},
                          {"follows_from", finding.follows_from},
                          {"allowed", is_allowed(options, finding)}});
    }
  }
  const nlohmann::json whole{{"schema", "touchstone-loop-atlas/1"},
                             {"device", setup.device.name},
                             {"grip", setup.grip.name},
                             {"stiffness_N_per_m", options.stiffness_N_per_m},
                             {"assumed", setup.assumed},
                             {"findings", findings},
                             {"cells", cells}};
  return whole.dump(2) + "\n";
}

report::Section findings_section(const std::vector<Judged>& all, const AtlasOptions& options) {
  report::Section section{"Findings", "", {}, false};
  report::Table table;
  table.columns = {"renderer", "finding", "felt [JND]", "on", "follows from", "allowed"};
  for (const Judged& judged : all) {
    for (const servo::AtlasFinding& finding : judged.findings) {
      table.rows.push_back(
          {{report::text_cell(judged.renderer), report::text_cell(finding.name),
            report::number_cell(fmt::format("{:.2g}", finding.jnd)),
            report::text_cell(fmt::format("{}", fmt::join(finding.where, ", "))),
            report::text_cell(finding.follows_from), report::text_cell(is_allowed(options, finding) ? "yes" : "")},
           "",
           {}});
    }
  }
  if (table.rows.empty()) {
    section.blocks.emplace_back(report::TextBlock{"None: nothing is felt that the god-object does not do too."});
  } else {
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

report::Page atlas_page(const std::vector<Judged>& all, const std::vector<servo::AtlasCase>& cases,
                        const servo::LoopSetup& setup, const AtlasOptions& options) {
  std::size_t stable = 0;
  report::Table table;
  table.caption = fmt::format("Springs of {:g} N/m where the renderer has that parameter, meshes of 10,000 triangles.",
                              options.stiffness_N_per_m);
  table.columns = {"renderer"};
  for (const servo::AtlasCase& own : cases) table.columns.push_back(own.name);
  for (const Judged& judged : all) {
    report::Table::Row row;
    row.cells.push_back(report::text_cell(judged.renderer));
    for (const servo::AtlasAnswer& answer : judged.answers) {
      report::Table::Cell cell = report::text_cell(words(answer));
      cell.tone = tone_of(answer.verdict);
      stable += answer.verdict == servo::Verdict::stable ? 1 : 0;
      row.cells.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  report::Page page;
  page.title = "Which renderer is stable where";
  page.subtitle = fmt::format("{} in a {} grip: {} of {} pairs of a renderer and a shape are stable.",
                              setup.device.name, setup.grip.name, stable, all.size() * cases.size());
  report::Section section{"Verdicts", "Each shape is pressed with 1 N and slid over along x at 16 mm/s.", {}, false};
  section.blocks.emplace_back(std::move(table));
  page.sections = {findings_section(all, options), section, setup_section(setup), not_modelled_section(),
                   report::provenance_section(report::make_provenance(apps::command_line()))};
  return page;
}

// The plug-ins' renderers, or the program's own where there is no plug-in; those that were asked for.
std::vector<rendering::Model> models_of(const AtlasOptions& options, const plugin::Plugins& plugins) {
  std::vector<rendering::Model> all;
  for (const auto& entry : renderers::renderer_catalogue())
    all.push_back(servo::atlas_model(entry, options.stiffness_N_per_m));
  const auto plugged = static_cast<std::ptrdiff_t>(all.size());
  for (const auto& entry : plugins.entries()) {
    all.push_back(servo::atlas_model(*entry, options.stiffness_N_per_m));
    all.back().provided = entry;
  }
  if (options.renderers.empty()) return plugins.entries().empty() ? all : std::vector(all.begin() + plugged, all.end());
  std::vector<rendering::Model> chosen;
  for (const std::string& name : options.renderers) {
    const auto found = std::ranges::find(all, name, &rendering::Model::renderer);
    if (found == all.end()) {
      std::vector<std::string> known;
      for (const rendering::Model& model : all) known.push_back(model.renderer);
      throw UsageError("--renderer: " + unknown_name("renderer", name, known));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

std::vector<servo::AtlasCase> cases_of(const AtlasOptions& options) {
  if (options.cases.empty()) return servo::atlas_cases();
  std::vector<servo::AtlasCase> chosen;
  for (const servo::AtlasCase& own : servo::atlas_cases()) {
    if (std::ranges::find(options.cases, own.name) != options.cases.end()) chosen.push_back(own);
  }
  return chosen;
}

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const servo::AtlasCase& own : servo::atlas_cases()) names.push_back(own.name);
  return names;
}

// The god-object's answers first: what it does too is no finding.
std::vector<Judged> judge_all(const std::vector<rendering::Model>& models, const std::vector<servo::AtlasCase>& cases,
                              const servo::LoopSetup& setup, double stiffness) {
  Progress progress("atlas", (models.size() + 1) * cases.size());
  std::size_t done = 0;
  const auto answers_of = [&](const rendering::Model& model) {
    std::vector<servo::AtlasAnswer> answers;
    for (const servo::AtlasCase& where : cases) {
      answers.push_back(servo::atlas_answer(renderers::built_in_catalogue(), synthetic::built_in_generators(), model,
                                            where, setup, {}));
      progress.update(++done);
    }
    return answers;
  };
  const auto& catalogue = renderers::renderer_catalogue();
  const auto god_object = std::ranges::find(catalogue, "god-object", &rendering::RendererEntry::name);
  const auto reference = answers_of(servo::atlas_model(*god_object, stiffness));
  std::vector<Judged> all;
  for (const rendering::Model& model : models) {
    Judged judged{model.renderer, answers_of(model), {}};
    judged.findings = servo::atlas_findings(judged.answers, reference);
    all.push_back(std::move(judged));
  }
  return all;
}

ExitStatus print(const std::vector<Judged>& all, const AtlasOptions& options) {
  std::vector<std::vector<std::string>> rows{{"renderer", "shape", "in the hand", "ideal servo [JND]", "kick [N]"}};
  bool answered = false, failed = false;
  std::vector<std::string> in_vain = options.allowed;
  for (const Judged& judged : all) {
    for (const servo::AtlasAnswer& answer : judged.answers) {
      rows.push_back({answer.renderer, answer.where, words(answer), fmt::format("{:.2g}", answer.worst.own.jnd),
                      fmt::format("{:.2g}", answer.worst.kick_N)});
      answered = answered || answer.verdict != servo::Verdict::cannot_tell;
    }
  }
  fmt::print("{}", report::align_columns(rows));
  for (const Judged& judged : all) {
    for (const servo::AtlasAnswer& answer : judged.answers) {
      if (!answer.refused.empty()) fmt::print("{} on {}: {}\n", answer.renderer, answer.where, answer.refused);
    }
    for (const servo::AtlasFinding& finding : judged.findings) {
      const bool allowed = is_allowed(options, finding);
      fmt::print("{}: {}{}\n", judged.renderer, words(finding), allowed ? " (allowed)" : "");
      failed = failed || !allowed;
      std::erase(in_vain, finding.name);
    }
  }
  for (const std::string& name : in_vain) fmt::print("allowed and not found: {}\n", name);
  if (!answered) {
    fmt::print("nothing could be judged\n");
    return ExitStatus::skipped;
  }
  return failed ? ExitStatus::failed : ExitStatus::passed;
}

ExitStatus atlas_command(const AtlasOptions& options) {
  const servo::LoopSetup setup = options.setup.make();
  const plugin::Plugins plugins = options.plugins.load();
  const auto cases = cases_of(options);
  const auto all = judge_all(models_of(options, plugins), cases, setup, options.stiffness_N_per_m);
  const std::string result = to_json(all, setup, options);
  if (!options.out.empty()) {
    const std::filesystem::path out = options.out;
    ensure_writable_folder(out);
    write_file(out / "result.json", result);
    write_html(out / "report.html", atlas_page(all, cases, setup, options));
  }
  if (!options.json.empty()) write_file(options.json, result);
  return print(all, options);
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
  command->add_option("--renderer", options->renderers,
                      "Renderers to judge: all of the plug-ins, or without a plug-in all of the program's own, where "
                      "not given");
  command->add_option("--case", options->cases, "Shapes to judge on; all where not given")
      ->check(CLI::IsMember(case_names()));
  command->add_option("--allow", options->allowed, "A finding that is known: it is reported and does not count")
      ->check(CLI::IsMember(
          std::vector<std::string>(servo::atlas_finding_names.begin(), servo::atlas_finding_names.end())));
  command->add_option("--out", options->out, "Folder for report.html and result.json");
  command->add_option("--json", options->json, "Write the answers as JSON");
  options->plugins.add_to(*command);
  command->footer(
      "Findings: unstable-below-limit, buzz-at-edges, buzz-with-friction, kick; what the god-object does too is none.\n"
      "Exit status: 0 no finding but those that are allowed, 1 another, 77 nothing could be judged: a renderer whose "
      "step takes more "
      "than half of the servo's period cannot run there.\n"
      "Examples:\n"
      "  touchstone loop atlas --device touch --grip light --out a\n"
      "  touchstone loop atlas --device touch-x --grip firm --stiffness 2000 --plugin ./libmine.so --json a.json\n"
      "  touchstone loop atlas --plugin ./libmine.so --allow buzz-at-edges\n"
      "  touchstone loop atlas --plugin ./libmine.so --case 'passive plane'");
  command->callback([options, &run] { run = [options] { return atlas_command(*options); }; });
}

}  // namespace touchstone::loop
