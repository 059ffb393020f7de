#include "tool_fitting/tool_fit_page.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <sstream>

#include "harness/report/evaluation_page.h"
#include "tool_reports/tool_plots.h"

namespace touchstone::tool_fitting {
using report::Table;
using report::Tone;

namespace {

report::Section plots(const recording::Recording& measured, const ToolFit& fit) {
  const std::array<tool_reports::WrenchLine, 3> lines{
      {{"measured", Tone::measured, false,
        [&](std::size_t i) {
          return Wrench{measured.f_W_N[i], measured.torque_W_Nm[i]};
        }},
       {"as declared", Tone::error, true, [&](std::size_t i) { return fit.declared_W[i]; }},
       {"fitted", Tone::rendered, true, [&](std::size_t i) { return fit.fitted_W[i]; }}}};
  return tool_reports::wrench_section("Measured and rendered", measured.motion.t_s, lines);
}

Table effects_table(const ToolFit& fit) {
  Table table;
  table.columns = {"effect", "value", "standard error", "unit", "p", "gain", "p of the gain", "rivals", "named"};
  for (const ToolEffect& effect : fit.effects) {
    std::string values, errors;
    for (std::size_t k = 0; k < effect.values.size(); ++k) {
      const char* const gap = k == 0 ? "" : ", ";
      values += gap + (effect.determined[k] ? fmt::format("{:.4g}", effect.values[k]) : std::string("undetermined"));
      errors += gap + fmt::format("{:.2g}", effect.standard_errors[k]);
    }
    std::string rivals;
    for (const std::string& rival : effect.rivals) rivals += (rivals.empty() ? "" : ", ") + rival;
    Table::Row row;
    row.cells = {report::text_cell(effect.name),
                 report::number_cell(values),
                 report::number_cell(errors),
                 report::text_cell(effect.unit),
                 report::number_cell(fmt::format("{:.2g}", effect.p)),
                 report::number_cell(fmt::format("{:.2g}", effect.gain.per_sample)),
                 report::number_cell(fmt::format("{:.2g}", effect.gain.p)),
                 report::text_cell(rivals),
                 report::text_cell(effect.named ? "yes" : "no")};
    row.detail = effect.what;
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

report::Page tool_fit_page(const recording::Recording& measured, const ToolFit& fit,
                           const report::Provenance& provenance) {
  report::Page page;
  page.title = "What the instrument adds: " + std::filesystem::path(measured.source).filename().string();
  std::istringstream text(tool_fit_text(fit));
  std::getline(text, page.subtitle);
  page.headlines = {
      {"force error", fmt::format("{:.3g}", fit.after.force_N), "N",
       fmt::format("RMS of what the fit has not seen; {:.3g} as declared", fit.before.force_N), Tone::error},
      {"torque error", fmt::format("{:.3g}", 1e3 * fit.after.torque_Nm), "mNm",
       fmt::format("RMS of what the fit has not seen; {:.3g} as declared", 1e3 * fit.before.torque_Nm), Tone::error}};
  report::Section found{
      "What was found",
      "Vectors are in the tool's axes. p: of the value being nought, on the fitted blocks. Gain: how much more "
      "likely (nats a sample) the model with the effect makes blocks that were not fitted than the one without "
      "it. Rivals explain the recording about as well in its place.",
      {},
      false};
  found.blocks.emplace_back(effects_table(fit));
  if (fit.misreading)
    found.blocks.emplace_back(report::TextBlock{"The recording is suspect: " + fit.misreading->what, Tone::warning});
  for (const std::string& remark : fit.remarks) found.blocks.emplace_back(report::TextBlock{remark, Tone::warning});
  page.sections.push_back(std::move(found));
  page.sections.push_back(plots(measured, fit));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::tool_fitting
