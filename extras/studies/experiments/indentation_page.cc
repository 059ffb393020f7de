#include "experiments/indentation_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/nearness.h"
#include "harness/report/evaluation_page.h"
#include "harness/stats/quantile.h"

namespace touchstone::experiments {
using report::Tone;

namespace {

double distance(const IndentationComparison& own, std::size_t condition) {
  return own.evaluation.conditions[condition].distance;
}

std::vector<Nearness> nearness_of(const std::vector<IndentationComparison>& comparisons) {
  std::vector<const perception::PerceptualEvaluation*> evaluations;
  evaluations.reserve(comparisons.size());
  for (const auto& own : comparisons) evaluations.push_back(&own.evaluation);
  return nearness(evaluations);
}

std::vector<std::string> names_of(const std::vector<IndentationComparison>& comparisons) {
  std::vector<std::string> names;
  for (const auto& condition : comparisons.front().evaluation.conditions) names.push_back(condition.name);
  return names;
}

report::Table distances_table(const std::vector<IndentationComparison>& comparisons) {
  report::Table table;
  table.caption = "Distance in perception space to one record of the approach";
  table.columns = {"condition", "median", "least", "largest", "nearest of all in"};
  for (std::size_t c = 0; c < indentation_conditions; ++c) {
    std::vector<double> own;
    std::size_t nearest = 0;
    for (const auto& comparison : comparisons) {
      own.push_back(distance(comparison, c));
      nearest += comparison.evaluation.conditions[c].rank_perception == 1 ? 1 : 0;
    }
    table.rows.push_back({{{comparisons.front().evaluation.conditions[c].name, false, Tone::neutral},
                           report::number_cell(stats::median(own)),
                           report::number_cell(*std::min_element(own.begin(), own.end())),
                           report::number_cell(*std::max_element(own.begin(), own.end())),
                           {fmt::format("{} of {}", nearest, own.size()), true, Tone::neutral}},
                          "",
                          {}});
  }
  return table;
}

report::LinePlot curve_plot(const Approach& approach) {
  report::LinePlot plot;
  plot.title = "The approach, and laws fitted to all of it";
  plot.x_label = "depth of the tip [um]";
  plot.y_label = "force [nN]";
  plot.height_px = 340;
  const std::size_t start = approach.contact - approach.contact / 10;
  const auto line_of = [&](std::string name, Tone tone, bool dashed, auto force_N) {
    report::Line line{std::move(name), {}, {}, tone, dashed, false};
    for (std::size_t i = start; i < approach.force_N.size(); i += 4) {
      line.x.push_back(1e6 * approach.depth_m[i]);
      line.y.push_back(1e9 * force_N(i));
    }
    plot.lines.push_back(std::move(line));
  };
  line_of("measured", Tone::measured, false, [&](std::size_t i) { return approach.force_N[i]; });
  const auto add = [&](const std::string& name, Tone tone, const PowerLaw& law) {
    line_of(name, tone, true, [&](std::size_t i) { return law.force_N(approach.depth_m[i]); });
  };
  add("F = k d", Tone::error, fit_power_law(approach, 1.0, 0, 1));
  add("F = c d^1.5", Tone::rendered, fit_power_law(approach, 1.5, 0, 1));
  const PowerLaw best = fit_power_law(approach, 0, 1);
  add(fmt::format("F = c d^{:.2f}, fitted", best.exponent), Tone::good, best);
  return plot;
}

}  // namespace

std::size_t measured_nearest(const std::vector<IndentationComparison>& comparisons) {
  return static_cast<std::size_t>(std::count_if(comparisons.begin(), comparisons.end(), [](const auto& own) {
    return own.evaluation.conditions.front().rank_perception == 1;
  }));
}

report::Page indentation_page(const Approach& approach, const std::vector<IndentationComparison>& comparisons,
                              const report::Provenance& provenance) {
  report::Page page;
  page.title = "An indentation, measured again and rendered";
  page.subtitle = "Does what was measured twice lie nearer together than a rendering that lacks the law of the depth?";
  const std::size_t nearest = measured_nearest(comparisons);
  page.headlines = {{"pairs where the record measured again is nearest", fmt::format("{}", nearest), "",
                     fmt::format("of {}", comparisons.size()),
                     nearest == comparisons.size() ? Tone::good : Tone::warning}};
  report::Section section{
      "Interleaved records of one approach",
      fmt::format(
          "Of every {} samples one goes to each record, so that the records share the sample, the path and the "
          "slow drift of the instrument but not its noise: a single curve offers no more. Laws are fitted to one "
          "record by least squares and rendered at the depths of another. Shown as a haptic interface would: 1 "
          "nN as 1 N, 1 um as 1 mm. Noise of the force {:.3g} nN, {} samples in contact.",
          interleaved, 1e9 * approach.noise_N, approach.force_N.size() - approach.contact),
      {},
      false};
  section.blocks = {distances_table(comparisons), nearness_table(nearness_of(comparisons), names_of(comparisons)),
                    curve_plot(approach)};
  page.sections.push_back(std::move(section));
  show_first_pair(page, comparisons.front().evaluation);
  page.sections.push_back(provenance_section(provenance));
  return page;
}

std::string indentation_to_json(const Approach& approach, const std::vector<IndentationComparison>& comparisons) {
  nlohmann::ordered_json document{{"schema", "touchstone-indentation/1"},
                                  {"force_noise_N", approach.noise_N},
                                  {"samples_in_contact", approach.force_N.size() - approach.contact},
                                  {"compared", comparisons.size()},
                                  {"measured_nearest", measured_nearest(comparisons)}};
  for (const auto& own : comparisons) {
    nlohmann::ordered_json pair{
        {"real_record", own.real}, {"other_record", own.other}, {"fitted_exponent", own.fitted_exponent}};
    for (const auto& condition : own.evaluation.conditions) pair["distance"][condition.name] = condition.distance;
    document["pairs"].push_back(pair);
  }
  return document.dump(2) + "\n";
}

}  // namespace touchstone::experiments
