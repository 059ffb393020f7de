#include "harness/pipeline/fitting/fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/report/console.h"
#include "harness/report/evaluation_page.h"
#include "harness/report/json_numbers.h"
#include "harness/report/metric_json.h"
#include "harness/report/page.h"
#include "harness/report/page_html.h"
#include "harness/report/quantity.h"

namespace touchstone::pipeline {
using report::LinePlot;
using report::Section;
using report::Tone;

namespace {

using nlohmann::json;

std::string interval_text(const Estimate& one) {
  if (!one.interval_known) return "not known";
  return fmt::format("{} to {}", report::display_number(one.low95),
                     report::display_quantity(one.high95, one.parameter.unit));
}

LinePlot profile_plot(const Estimate& one, const FitResult& result) {
  LinePlot plot;
  plot.title = fmt::format("{} over {}", result.metric, one.parameter.name);
  plot.x_label = fmt::format("{} [{}]", one.parameter.name, one.parameter.unit);
  plot.y_label = fmt::format("{} [{}]", result.metric, result.metric_unit);
  plot.height_px = 320;
  plot.half_width = result.estimates.size() > 1;
  plot.lines.push_back({"on the fitted ranges", one.profile_value, one.profile_metric, Tone::error, false, false});
  plot.lines.push_back({fmt::format("minimum at {}", report::display_quantity(one.value, one.parameter.unit)),
                        {one.value},
                        {result.fit_after},
                        Tone::rendered,
                        false,
                        true});
  if (one.interval_known) plot.bands.emplace_back(one.low95, one.high95);
  plot.note =
      fmt::format("{}{}", result.estimates.size() > 1 ? "The other parameters are fitted anew at every point. " : "",
                  one.interval_known ? "Shaded: the 95 % interval." : "");
  return plot;
}

Section force_section(const FitResult& result) {
  Section section{
      "Measured and predicted force",
      "Over the whole recording. Shaded: the time ranges that were fitted; the rest was not seen by the fit.",
      {},
      false};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char name = "xyz"[axis];
    LinePlot plot;
    plot.title = fmt::format("Force along {}", name);
    plot.x_label = "time [s]";
    plot.y_label = fmt::format("F{} [N]", name);
    plot.height_px = 230;
    plot.link = "time";
    plot.lines = {line_of(result.signals[axis], "measured", Tone::measured, 1.0),
                  line_of(result.signals[axis + 3], "model", Tone::rendered, 1.0)};
    plot.bands = result.fit_bands;
    section.blocks.emplace_back(std::move(plot));
  }
  return section;
}

// What the repeat says of the scored error; empty without one, and where that is no RMS of the force.
std::string against_repeat(const FitResult& result) {
  if (!result.floor || result.metric != "rms_force_error") return "";
  return fmt::format("The scored error of {} is {}.", report::display_quantity(result.score_after, "N"),
                     result.floor->verdict(result.score_after));
}

report::Page fit_page(const FitResult& result) {
  report::Page page;
  page.title = result.title;
  page.subtitle = fmt::format("Parameters identified by minimising {} on the time ranges {}, and scored on {}.",
                              result.metric, result.fit_range, result.score_range);
  for (const Estimate& one : result.estimates) {
    const report::DisplayUnit unit = report::display_unit(one.parameter.unit, one.value);
    page.headlines.push_back(
        {one.parameter.name, report::display_number(one.value * unit.factor), unit.name == "1" ? "" : unit.name,
         one.interval_known ? "95 %: " + interval_text(one) : "no interval: see below", Tone::rendered});
  }
  const auto headline = [&](std::string label, double value, double before) {
    const report::DisplayUnit unit = report::display_unit(result.metric_unit, value);
    page.headlines.push_back(
        {std::move(label), report::display_number(value * unit.factor), unit.name,
         fmt::format("{} with the model as given", report::display_quantity(before, result.metric_unit)), Tone::error});
  };
  headline(fmt::format("{}, scored ({})", result.metric, result.score_range), result.score_after, result.score_before);
  headline(fmt::format("{}, fitted ({})", result.metric, result.fit_range), result.fit_after, result.fit_before);
  if (result.floor) {
    page.headlines.push_back({"floor of a repeat", report::display_number(result.floor->force_N), "N",
                              "what one recording does not repeat: RMS difference over the root of 2",
                              Tone::reference});
  }
  Section fit{"The fit", against_repeat(result), {}, false};
  for (const std::string& warning : result.warnings) fit.blocks.emplace_back(report::TextBlock{warning, Tone::warning});
  report::Table table{"", {"parameter", "given", "searched", "fitted", "95 % interval"}, {}, ""};
  for (const Estimate& one : result.estimates) {
    table.rows.push_back({{{one.parameter.name},
                           {report::display_quantity(one.parameter.initial, one.parameter.unit), true},
                           {fmt::format("{:.4g} to {}", one.parameter.low,
                                        report::display_setting(one.parameter.high, one.parameter.unit)),
                            true},
                           {report::display_quantity(one.value, one.parameter.unit), true},
                           {interval_text(one), true}},
                          "",
                          std::nullopt});
  }
  fit.blocks.emplace_back(std::move(table));
  fit.blocks.emplace_back(report::TextBlock{result.interval_note});
  for (const Estimate& one : result.estimates) fit.blocks.emplace_back(profile_plot(one, result));
  page.sections.push_back(std::move(fit));
  page.sections.push_back(force_section(result));
  page.sections.push_back({"Metrics on the scored ranges",
                           "Of the fitted model, on samples that the fit did not see unless the ranges overlap.",
                           {report::metrics_table(result.score_metrics)},
                           false});
  page.sections.push_back({"Model",
                           "With the fitted parameters; model.json beside this page.",
                           {report::Code{"", result.model_text}},
                           false});
  page.sections.push_back(provenance_section(result.provenance));
  page.footer =
      fmt::format("Touchstone {}. {} evaluations of the metric.", result.provenance.build.version, result.evaluations);
  return page;
}

}  // namespace

std::string fit_to_json(const FitResult& result) {
  json parameters = json::array();
  for (const Estimate& one : result.estimates) {
    json entry{{"name", one.parameter.name},
               {"unit", one.parameter.unit},
               {"initial", one.parameter.initial},
               {"value", report::exact_number(one.value)},
               {"bounds", {one.parameter.low, one.parameter.high}},
               {"interval95", nullptr},
               {"profile",
                {{"value", report::plotted_numbers(one.profile_value)},
                 {"metric", report::plotted_numbers(one.profile_metric)}}}};
    if (one.interval_known) entry["interval95"] = {report::exact_number(one.low95), report::exact_number(one.high95)};
    parameters.push_back(std::move(entry));
  }
  json metrics = json::array();
  for (const metrics::MetricResult& metric : result.score_metrics) metrics.push_back(report::metric_to_json(metric));
  json signals = json::array();
  for (const metrics::Series& series : result.signals) signals.push_back(report::series_to_json(series));
  json document{{"schema", "touchstone-fit/1"},
                {"title", result.title},
                {"metric", {{"name", result.metric}, {"unit", result.metric_unit}}},
                {"parameters", std::move(parameters)},
                {"fit",
                 {{"range", result.fit_range},
                  {"samples", result.fit_samples},
                  {"before", report::exact_number(result.fit_before)},
                  {"after", report::exact_number(result.fit_after)}}},
                {"score",
                 {{"range", result.score_range},
                  {"samples", result.score_samples},
                  {"before", report::exact_number(result.score_before)},
                  {"after", report::exact_number(result.score_after)},
                  {"metrics", std::move(metrics)}}},
                {"evaluations", result.evaluations},
                {"interval_note", result.interval_note},
                {"warnings", result.warnings},
                {"signals", std::move(signals)},
                {"model", json::parse(result.model_text)},
                {"provenance", provenance_to_json(result.provenance)}};
  if (result.floor) {
    document["repeat_floor"] = {{"force_N", report::exact_number(result.floor->force_N)},
                                {"position_m", report::exact_number(result.floor->position_m)},
                                {"shift_s", report::exact_number(result.floor->shift_s)},
                                {"unshifted_N", report::exact_number(result.floor->unshifted_N)},
                                {"steadiest_N", report::exact_number(result.floor->steadiest_N)},
                                {"least_steady_N", report::exact_number(result.floor->least_steady_N)},
                                {"repeat", result.floor->source}};
  }
  return document.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string fit_table(const FitResult& result) {
  std::vector<std::vector<std::string>> rows{{"parameter", "given", "fitted", "95 % interval"}};
  for (const Estimate& one : result.estimates) {
    rows.push_back({one.parameter.name, report::display_quantity(one.parameter.initial, one.parameter.unit),
                    report::display_quantity(one.value, one.parameter.unit), interval_text(one)});
  }
  std::vector<std::vector<std::string>> scores{{result.metric, "time ranges", "samples", "as given", "fitted"}};
  scores.push_back({"fit", result.fit_range, fmt::format("{}", result.fit_samples),
                    report::display_quantity(result.fit_before, result.metric_unit),
                    report::display_quantity(result.fit_after, result.metric_unit)});
  scores.push_back({"score", result.score_range, fmt::format("{}", result.score_samples),
                    report::display_quantity(result.score_before, result.metric_unit),
                    report::display_quantity(result.score_after, result.metric_unit)});
  const std::string floor = against_repeat(result);
  return report::align_columns(rows) + "\n" + report::align_columns(scores) +
         (floor.empty() ? "" : "\n" + floor + "\n");
}

void write_fit(const FitResult& result, const std::filesystem::path& folder) {
  write_file(folder / "model.json", model_to_json(result.model, folder));
  write_file(folder / "fit.json", fit_to_json(result));
  write_html(folder / "report.html", fit_page(result));
}

}  // namespace touchstone::pipeline
