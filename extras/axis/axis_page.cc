#include "axis_page.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>

#include "harness/report/evaluation_page.h"

namespace touchstone::axis {
using report::Line;
using report::Section;
using report::Tone;

namespace {

// Measured there and back, and fitted, over the place and over time.
Section plots(const AxisInput& input, const AxisFit& fit) {
  constexpr std::size_t most_plotted = 6000;
  const AxisRun& run = input.run;
  const AxisWords& words = input.words;
  const std::vector<double> fitted = fitted_load(fit, run);
  const std::string load_label = fmt::format("{} [{}]", words.load, words.load_unit);
  report::LinePlot over_place, over_time;
  over_place.title = fmt::format("{} over {}", words.load, words.place);
  over_place.x_label = fmt::format("{} [{}]", words.place, words.place_unit);
  over_place.height_px = 380;
  over_time.title = fmt::format("{} over time", words.load);
  over_time.x_label = "time [s]";
  over_place.y_label = over_time.y_label = load_label;
  Line there{"measured, there", {}, {}, Tone::measured, false, false},
      back{"measured, back", {}, {}, Tone::reference, false, false};
  Line model{"fitted", {}, {}, Tone::rendered, true, false};
  Line measured{"measured", {}, {}, Tone::measured, false, false},
      in_time{"fitted", {}, {}, Tone::rendered, true, false}, residual{"residual", {}, {}, Tone::error, false, false};
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const std::size_t stride = run.t_s.size() / most_plotted + 1;
  for (std::size_t i = stride; i < run.t_s.size(); i += stride) {
    const bool forth = run.place[i] >= run.place[i - stride];
    for (Line* const line : {&there, &back, &model}) line->x.push_back(run.place[i]);
    there.y.push_back(forth ? run.load[i] : gap);
    back.y.push_back(forth ? gap : run.load[i]);
    model.y.push_back(fitted[i]);
    for (Line* const line : {&measured, &in_time, &residual}) line->x.push_back(run.t_s[i]);
    measured.y.push_back(run.load[i]);
    in_time.y.push_back(fitted[i]);
    residual.y.push_back(run.load[i] - fitted[i]);
  }
  over_place.lines = {std::move(there), std::move(back), std::move(model)};
  over_time.lines = {std::move(measured), std::move(in_time), std::move(residual)};
  Section section{"Measured and fitted", "", {}, false};
  section.blocks.emplace_back(std::move(over_place));
  section.blocks.emplace_back(std::move(over_time));
  return section;
}

}  // namespace

report::Page axis_page(const AxisInput& input, const AxisFit& fit, const std::optional<AxisFloor>& floor,
                       const report::Provenance& provenance) {
  const AxisWords& words = input.words;
  report::Page page;
  page.title = fmt::format("{} over {} of {}", words.load, words.place,
                           std::filesystem::path(input.run.source).filename().string());
  page.subtitle = "One axis: what the place makes, and what the motion adds.";
  for (const AxisTerm& term : fit.terms) {
    page.headlines.push_back({to_string(term.kind), fmt::format("{:.4g}", term.value), unit_of_term(term.kind, words),
                              term.standard_error ? fmt::format("+- {:.2g}", *term.standard_error) : "",
                              Tone::rendered});
  }
  page.headlines.push_back({"held-out residual", fmt::format("{:.4g}", fit.after), words.load_unit,
                            fmt::format("RMS; {:.4g} about its mean", fit.before), Tone::error});
  if (floor) {
    page.headlines.push_back({"floor of a repeat", fmt::format("{:.4g}", floor->value), words.load_unit,
                              "what one recording does not repeat: RMS difference over the root of 2",
                              Tone::reference});
  }
  Section found{"What was found", "", {}, false};
  for (const std::string& remark : axis_remarks(fit, words, floor)) {
    found.blocks.emplace_back(report::TextBlock{remark, Tone::warning});
  }
  found.blocks.emplace_back(report::Code{"", axis_values(fit, words)});
  page.sections.push_back(std::move(found));
  page.sections.push_back(plots(input, fit));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone::axis
