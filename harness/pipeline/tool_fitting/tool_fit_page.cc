#include "harness/pipeline/tool_fitting/tool_fit_page.h"

#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <sstream>

#include "harness/report/evaluation_page.h"

namespace touchstone::pipeline {
namespace {

// More points than this cannot be told apart on a screen.
constexpr std::size_t kMostPlotted = 4000;

Line line_over_time(const recording::Recording& measured, const char* name, Tone tone, bool dashed,
                    const std::function<double(std::size_t)>& value) {
  Line line{name, {}, {}, tone, dashed, false};
  const std::size_t stride = measured.size() / kMostPlotted + 1;
  for (std::size_t i = 0; i < measured.size(); i += stride) {
    line.x.push_back(measured.motion.t_s[i]);
    line.y.push_back(value(i));
  }
  return line;
}

Section plots(const recording::Recording& measured, const ToolFit& fit) {
  Section section{"Measured and rendered", "", {}, false};
  for (int k = 0; k < 3; ++k) {
    LinePlot plot;
    plot.title = fmt::format("force along {}", "xyz"[k]);
    plot.x_label = "time [s]";
    plot.y_label = "force [N]";
    plot.link = "time";
    plot.lines = {line_over_time(measured, "measured", Tone::measured, false,
                                 [&, k](std::size_t i) { return measured.f_W_N[i][k]; }),
                  line_over_time(measured, "as declared", Tone::error, true,
                                 [&, k](std::size_t i) { return fit.declared_W[i].f_N[k]; }),
                  line_over_time(measured, "fitted", Tone::rendered, true,
                                 [&, k](std::size_t i) { return fit.fitted_W[i].f_N[k]; })};
    section.blocks.emplace_back(std::move(plot));
  }
  for (int k = 0; k < 3; ++k) {
    LinePlot plot;
    plot.title = fmt::format("torque about {}", "xyz"[k]);
    plot.x_label = "time [s]";
    plot.y_label = "torque [mNm]";
    plot.link = "time";
    plot.lines = {line_over_time(measured, "measured", Tone::measured, false,
                                 [&, k](std::size_t i) { return 1e3 * measured.torque_W_Nm[i][k]; }),
                  line_over_time(measured, "as declared", Tone::error, true,
                                 [&, k](std::size_t i) { return 1e3 * fit.declared_W[i].torque_Nm[k]; }),
                  line_over_time(measured, "fitted", Tone::rendered, true,
                                 [&, k](std::size_t i) { return 1e3 * fit.fitted_W[i].torque_Nm[k]; })};
    section.blocks.emplace_back(std::move(plot));
  }
  return section;
}

Table effects_table(const ToolFit& fit) {
  Table table;
  table.columns = {"effect", "value", "standard error", "unit", "p", "named"};
  for (const ToolEffect& effect : fit.effects) {
    std::string values, errors;
    for (std::size_t k = 0; k < effect.values.size(); ++k) {
      const char* const gap = k == 0 ? "" : ", ";
      values += gap + (effect.determined[k] ? fmt::format("{:.4g}", effect.values[k]) : std::string("undetermined"));
      errors += gap + fmt::format("{:.2g}", effect.standard_errors[k]);
    }
    Table::Row row;
    row.cells = {text_cell(effect.name),
                 number_cell(values),
                 number_cell(errors),
                 text_cell(effect.unit),
                 number_cell(fmt::format("{:.2g}", effect.p)),
                 text_cell(effect.named ? "yes" : "no")};
    row.detail = effect.what;
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Page tool_fit_page(const recording::Recording& measured, const ToolFit& fit, const Provenance& provenance) {
  Page page;
  page.title = "What the instrument adds: " + std::filesystem::path(measured.source).filename().string();
  std::istringstream text(tool_fit_text(fit));
  std::getline(text, page.subtitle);
  page.headlines = {
      {"force error", fmt::format("{:.3g}", fit.after.force_N), "N",
       fmt::format("RMS of what the fit has not seen; {:.3g} as declared", fit.before.force_N), Tone::error},
      {"torque error", fmt::format("{:.3g}", 1e3 * fit.after.torque_Nm), "mNm",
       fmt::format("RMS of what the fit has not seen; {:.3g} as declared", 1e3 * fit.before.torque_Nm), Tone::error}};
  Section found{"What was found", "Vectors are in the tool's axes.", {}, false};
  found.blocks.emplace_back(effects_table(fit));
  for (const std::string& remark : fit.remarks) found.blocks.emplace_back(TextBlock{remark, Tone::warning});
  page.sections.push_back(std::move(found));
  page.sections.push_back(plots(measured, fit));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::pipeline
