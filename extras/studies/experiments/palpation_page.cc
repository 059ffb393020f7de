#include "experiments/palpation_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/nearness.h"
#include "harness/report/evaluation_page.h"

namespace touchstone::experiments {
using report::Tone;

namespace {

std::size_t nearer(const std::vector<RowComparison>& comparisons) {
  return static_cast<std::size_t>(std::count_if(comparisons.begin(), comparisons.end(),
                                                [](const auto& own) { return own.same() < own.rendered(); }));
}

}  // namespace

report::Page palpation_page(const recording::Recording& recording, const std::vector<RowComparison>& comparisons,
                            const report::Provenance& provenance) {
  report::Page page;
  page.title = "Two rows of one object, and a rendering of it";
  page.subtitle = "Does what was measured twice lie nearer together than a rendering that lacks the object's shape?";
  const bool all = nearer(comparisons) == comparisons.size();
  page.headlines = {{"rows where the measured neighbour is nearer", fmt::format("{}", nearer(comparisons)), "",
                     fmt::format("of {}", comparisons.size()), all ? Tone::good : Tone::warning}};
  report::Section section{
      "Every row against the next one",
      "Rows of presses of one raster, about 2 mm apart. Distance in perception space of a row to the next row as "
      "it was measured, and to what one spring on one plane (fitted to the whole recording) makes of the next "
      "row's motion: the same motion, without the object's shape and the variation of its stiffness.",
      {},
      false};
  report::LinePlot plot;
  plot.title = "Distance to the neighbouring row";
  plot.x_label = "start of the row [s]";
  plot.y_label = "distance in perception space";
  report::Line same{"as measured", {}, {}, Tone::measured, false, true};
  report::Line rendered{"rendered by one spring on one plane", {}, {}, Tone::rendered, true, true};
  report::Table table;
  table.columns = {"row from [s]", "to [s]", "next row from [s]", "next row, measured", "next row, rendered"};
  for (const auto& own : comparisons) {
    const double start_s = recording.motion.t_s[own.row.first];
    same.x.push_back(start_s);
    same.y.push_back(own.same());
    rendered.x.push_back(start_s);
    rendered.y.push_back(own.rendered());
    table.rows.push_back({{report::number_cell(start_s), report::number_cell(recording.motion.t_s[own.row.end - 1]),
                           report::number_cell(recording.motion.t_s[own.next.first]), report::number_cell(own.same()),
                           report::number_cell(own.rendered())},
                          "",
                          {}});
  }
  plot.lines = {std::move(same), std::move(rendered)};
  std::vector<const perception::PerceptualEvaluation*> evaluations;
  evaluations.reserve(comparisons.size());
  for (const auto& own : comparisons) evaluations.push_back(&own.evaluation);
  table.caption = "Every row";
  section.blocks = {nearness_table(nearness(evaluations), {"measured", "rendered"}), std::move(plot), std::move(table)};
  page.sections.push_back(std::move(section));
  show_first_pair(page, comparisons.front().evaluation);
  page.sections.push_back(provenance_section(provenance));
  return page;
}

std::string palpation_to_json(const recording::Recording& recording, const std::vector<RowComparison>& comparisons) {
  nlohmann::ordered_json document{
      {"schema", "touchstone-palpation/1"}, {"compared", comparisons.size()}, {"measured_nearer", nearer(comparisons)}};
  for (const auto& own : comparisons) {
    document["rows"].push_back({{"row_from_s", recording.motion.t_s[own.row.first]},
                                {"next_row_from_s", recording.motion.t_s[own.next.first]},
                                {"distance_measured", own.same()},
                                {"distance_rendered", own.rendered()}});
  }
  return document.dump(2) + "\n";
}

}  // namespace touchstone::experiments
