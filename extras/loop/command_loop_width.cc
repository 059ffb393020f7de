#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/json_numbers.h"
#include "harness/report/page_html.h"
#include "loop_report.h"
#include "servo/width.h"
#include "setup_flags.h"

namespace touchstone::loop {
namespace {

struct Axis {
  servo::WidthOver over;
  const char* name;
  const char* unit;
  double shown;  // times the SI value
  double most;   // SI, where --most is not given
};
std::string label_of(const Axis& axis) { return fmt::format("{} [{}]", axis.name, axis.unit); }
const std::map<std::string, Axis>& axes() {
  static const std::map<std::string, Axis> known{
      {"damping", {servo::WidthOver::virtual_damping, "virtual damping", "N s/m", 1.0, 40.0}},
      {"latency", {servo::WidthOver::latency, "latency", "ms", 1e3, 5e-3}},
      {"period", {servo::WidthOver::period, "period", "ms", 1e3, 5e-3}}};
  return known;
}

struct WidthOptions {
  SetupFlags setup;
  std::vector<std::string> grips{"light", "firm"};
  std::string over = "damping", out, json;
  double most = 0.0;
  int points = 13;
};

struct GripWidth {
  servo::LoopSetup setup;
  std::vector<servo::WidthPoint> points;
};

report::LinePlot width_plot(const std::vector<GripWidth>& widths, const Axis& axis) {
  report::LinePlot plot{"The stiffest wall", label_of(axis), "stiffness [N/m]", {}, {}, {}, "", ""};
  plot.log_y = true;
  plot.height_px = 420;
  const auto add = [&](const std::string& name, const GripWidth& width, double servo::WidthPoint::*what,
                       report::Tone tone, bool dashed) {
    report::Line line{name, {}, {}, tone, dashed, !dashed};
    for (const servo::WidthPoint& point : width.points) {
      line.x.push_back(axis.shown * point.at);
      line.y.push_back(point.*what > 0.0 ? point.*what : std::nan(""));
    }
    plot.lines.push_back(std::move(line));
  };
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const std::string& grip = widths[i].setup.grip.name;
    const report::Tone tone = i % 2 == 0 ? report::Tone::rendered : report::Tone::measured;
    add("nothing is felt, " + grip, widths[i], &servo::WidthPoint::unfelt_N_per_m, tone, false);
    add("linear theory, " + grip, widths[i], &servo::WidthPoint::linear_N_per_m, tone, true);
  }
  if (std::ranges::any_of(widths.front().points, [](const auto& point) { return point.passive_N_per_m > 0.0; }))
    add("passive with every hand", widths.front(), &servo::WidthPoint::passive_N_per_m, report::Tone::error, true);
  plot.note =
      "Below a solid line the loop is stable in that hand. Linear theory: the eigenvalues of the sampled loop. "
      "Passive: Colgate and Schenkel 1997, from the damping of the device alone; no line where it has none.";
  return plot;
}

std::vector<std::vector<std::string>> table_of(const std::vector<GripWidth>& widths, const Axis& axis) {
  const auto shown = [](double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "none"; };
  std::vector<std::vector<std::string>> rows{{"grip", label_of(axis), "nothing is felt [N/m]", "not thrown out [N/m]",
                                              "linear theory [N/m]", "passive [N/m]"}};
  for (const GripWidth& width : widths) {
    for (const servo::WidthPoint& point : width.points) {
      rows.push_back({width.setup.grip.name, shown(axis.shown * point.at), shown(point.unfelt_N_per_m),
                      shown(point.held_N_per_m), shown(point.linear_N_per_m), shown(point.passive_N_per_m)});
    }
  }
  return rows;
}

std::string to_json(const std::vector<GripWidth>& widths, const std::string& over) {
  nlohmann::json grips = nlohmann::json::array();
  for (const GripWidth& width : widths) {
    nlohmann::json points = nlohmann::json::array();
    for (const servo::WidthPoint& point : width.points) {
      points.push_back({{"at", point.at},
                        {"unfelt_N_per_m", report::exact_number(point.unfelt_N_per_m)},
                        {"held_N_per_m", report::exact_number(point.held_N_per_m)},
                        {"linear_N_per_m", report::exact_number(point.linear_N_per_m)},
                        {"passive_N_per_m", report::exact_number(point.passive_N_per_m)}});
    }
    grips.push_back({{"grip", width.setup.grip.name}, {"assumed", width.setup.assumed}, {"points", points}});
  }
  const nlohmann::json whole{{"schema", "touchstone-loop-width/1"},
                             {"device", widths.front().setup.device.name},
                             {"over", over},
                             {"grips", grips}};
  return whole.dump(2) + "\n";
}

void write_report(const WidthOptions& options, const std::vector<GripWidth>& widths, const Axis& axis) {
  report::Page page;
  page.title = "How stiff a wall can be";
  const auto& shown = widths.front().points.front();
  page.subtitle = fmt::format("{}, {} of {:g} {}, in a {} grip: nothing is felt of the loop up to {:.0f} N/m.",
                              widths.front().setup.device.name, axis.name, axis.shown * shown.at, axis.unit,
                              widths.front().setup.grip.name, shown.unfelt_N_per_m);
  report::Section picture{"Stable region", "", {}, false};
  picture.blocks.emplace_back(width_plot(widths, axis));
  report::Section figures{"Figures", "", {}, true};
  report::Table table;
  const auto rows = table_of(widths, axis);
  table.columns = rows.front();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    report::Table::Row row;
    for (const std::string& cell : rows[i]) row.cells.push_back(report::number_cell(cell));
    table.rows.push_back(std::move(row));
  }
  figures.blocks.emplace_back(std::move(table));
  page.sections = {picture, figures};
  for (const GripWidth& width : widths) page.sections.push_back(setup_section(width.setup));
  page.sections.push_back(not_modelled_section());
  report::Provenance provenance = report::make_provenance(apps::command_line());
  page.sections.push_back(report::provenance_section(provenance));
  const std::filesystem::path out = options.out;
  ensure_writable_folder(out);
  write_file(out / "result.json", to_json(widths, options.over));
  write_html(out / "report.html", page);
}

ExitStatus width_command(const WidthOptions& options) {
  const Axis& axis = axes().at(options.over);
  const double most = options.most > 0.0 ? options.most / axis.shown : axis.most;
  std::vector<double> at;
  for (int i = 0; i < options.points; ++i) {
    // A period of nothing there is not.
    const int step = options.over == "period" ? i + 1 : i;
    const int steps = options.over == "period" ? options.points : options.points - 1;
    at.push_back(most * step / steps);
  }
  std::vector<GripWidth> widths;
  for (const std::string& grip : options.grips) widths.push_back({options.setup.make(options.setup.device, grip), {}});
  Progress progress("grips", widths.size());
  for (std::size_t i = 0; i < widths.size(); ++i) {
    widths[i].points = stable_width(widths[i].setup, axis.over, at, {});
    progress.update(i + 1);
  }
  if (!options.out.empty()) write_report(options, widths, axis);
  if (!options.json.empty()) write_file(options.json, to_json(widths, options.over));
  fmt::print("{}", report::align_columns(table_of(widths, axis)));
  for (const std::string& sentence : widths.front().setup.assumed) fmt::print("assumed: {}\n", sentence);
  return ExitStatus::passed;
}

}  // namespace

void add_width(CLI::App& loop, apps::Run& run) {
  auto* const command = loop.add_subcommand(
      "width", "The stiffest wall that is stable, over virtual damping, latency or period, beside theory");
  auto options = std::make_shared<WidthOptions>();
  command->add_option("--device", options->setup.device, "As of `touchstone loop`")->capture_default_str();
  command->add_option("--grip", options->grips, "As of `touchstone loop`; may be repeated")->capture_default_str();
  options->setup.add_figures_to(*command);
  command->add_option("--over", options->over, "What changes along the picture: damping, latency, period")
      ->check(CLI::IsMember({"damping", "latency", "period"}))
      ->capture_default_str();
  command->add_option("--most", options->most, "Its largest value, in N s/m or ms: 40 N s/m or 5 ms where not given")
      ->check(CLI::PositiveNumber);
  command->add_option("--points", options->points, "How many values")->check(CLI::Range(2, 200))->capture_default_str();
  command->add_option("--out", options->out, "Folder for report.html and result.json");
  command->add_option("--json", options->json, "Write the figures as JSON");
  command->footer(
      "Examples:\n"
      "  touchstone loop width --device touch --out w\n"
      "  touchstone loop width --device falcon --grip firm --set mass_kg=0.15 --set latency_s=0.002 --over damping\n"
      "  touchstone loop width --device touch-x --over latency --most 10");
  command->callback([options, &run] { run = [options] { return width_command(*options); }; });
}

}  // namespace touchstone::loop
