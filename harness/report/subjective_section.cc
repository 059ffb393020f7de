// The part of a perceptual report that holds the methods against people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/report/perception_page.h"
#include "harness/report/perception_plots.h"

namespace touchstone::report {
namespace {

using namespace perception_plots;
using perception::PerceptualEvaluation;

// The scale from a little below its least value to a little above its largest, or of their differences.
std::vector<double> grid(double low, double high) {
  constexpr int points = 60;
  const double margin = 0.1 * (high - low);
  std::vector<double> result;
  for (int i = 0; i <= points; ++i) result.push_back(low - margin + (high - low + 2.0 * margin) * i / points);
  return result;
}

LinePlot fraction_curve(const PerceptualEvaluation& e, const perception::SubjectiveComparison& people) {
  const auto& scale = people.bradley_terry;
  LinePlot plot;
  plot.title = "Fraction preferred over the psychological scale (figure 12)";
  plot.x_label = "psychological scale (Bradley-Terry), with its standard error";
  plot.y_label = "fraction preferred";
  plot.height_px = 380;
  const auto [low, high] = std::minmax_element(scale.value.begin(), scale.value.end());
  Line model{"model", grid(*low, *high), {}, Tone::neutral, true, false};
  for (const double v : model.x) model.y.push_back(perception::expected_fraction(scale, v));
  plot.lines.push_back(std::move(model));
  for (std::size_t c = 0; c < e.conditions.size(); ++c) {
    const double error = scale.standard_error.empty() ? 0.0 : scale.standard_error[c];
    Line own = perception_plots::line_of(e, c + 1);
    own.markers = true;
    for (const double x : {scale.value[c] - error, scale.value[c], scale.value[c] + error}) {
      own.x.push_back(x);
      own.y.push_back(people.fraction_preferred[c]);
    }
    plot.lines.push_back(std::move(own));
  }
  return plot;
}

LinePlot pair_curve(const PerceptualEvaluation& e, const perception::SubjectiveComparison& people) {
  const auto& scale = people.bradley_terry;
  LinePlot plot;
  plot.title = "Every pair: how often the one that lies higher was chosen";
  plot.x_label = "difference on the scale";
  plot.y_label = "share of the answers";
  plot.height_px = 340;
  Line pairs{"pairs, observed", {}, {}, Tone::measured, false, true};
  double largest = 0.0;
  for (const auto& own : people.pairs) {
    const double difference = scale.value[own.a] - scale.value[own.b];
    for (const double gap : {0.0, std::nan("")}) {  // marks alone
      pairs.x.push_back(std::abs(difference) + gap);
      pairs.y.push_back((difference >= 0.0 ? own.a_chosen : 1.0 - own.a_chosen) + gap);
    }
    largest = std::max(largest, std::abs(difference));
  }
  Line model{"model", {}, {}, Tone::rendered, true, false};
  for (const double difference : grid(0.0, largest)) {
    if (difference < 0.0) continue;
    model.x.push_back(difference);
    model.y.push_back(perception::expected_preference(scale, difference));
  }
  plot.lines = {std::move(pairs), std::move(model)};
  plot.note = fmt::format(
      "{} conditions make {} pairs; the fit of the scale shows here: through the fractions on the "
      "above maximum likelihood passes of itself.",
      e.conditions.size(), people.pairs.size());
  return plot;
}

std::string with_interval(const perception::RankCorrelation& own) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f}), p = {:.3f}", own.coefficient, own.low95, own.high95, own.p_two_sided);
}

}  // namespace

Section agreement_section(const PerceptualEvaluation& e, const perception::SubjectiveComparison& people) {
  Section section{"Against the subjective scale",
                  fmt::format("{} answers of {} subjects, as paired comparisons.", people.answers, people.subjects),
                  {},
                  false};
  Table scales;
  scales.caption =
      "Psychological scales, larger is more like the real process; standard errors by leaving out one subject.";
  scales.columns = {"condition", "fraction preferred", std::string(name_of(people.bradley_terry.model)),
                    std::string(name_of(people.thurstone.model))};
  const auto value = [](const perception::PsychologicalScale& scale, std::size_t c) {
    return scale.standard_error.empty() ? fmt::format("{:.3f}", scale.value[c])
                                        : fmt::format("{:.3f} +- {:.3f}", scale.value[c], scale.standard_error[c]);
  };
  for (std::size_t c = 0; c < e.conditions.size(); ++c) {
    scales.rows.push_back({{text_cell(e.conditions[c].name),
                            {fmt::format("{:.3f}", people.fraction_preferred[c]), true, Tone::neutral},
                            {value(people.bradley_terry, c), true, Tone::neutral},
                            {value(people.thurstone, c), true, Tone::neutral}},
                           "",
                           {}});
  }
  section.blocks.emplace_back(std::move(scales));
  Facts facts;
  for (const auto* scale : {&people.bradley_terry, &people.thurstone}) {
    facts.rows.emplace_back(
        std::string(name_of(scale->model)),
        fmt::format("misfit chi^2 = {:.3g} on {} degrees of freedom, p = {:.3g}{}{}", scale->misfit,
                    scale->degrees_of_freedom, scale->misfit_p, scale->remark.empty() ? "" : "; ", scale->remark));
  }
  facts.rows.emplace_back("Order of presentation",
                          fmt::format("{:.3f} +- {:.3f} in favour of what came first",
                                      people.bradley_terry.order_effect, people.bradley_terry.order_effect_error));
  double triads = 0.0;
  double rounds = 0.0;
  for (const auto& own : people.triads) {
    triads += own.triads * static_cast<double>(own.complete_rounds);
    rounds += static_cast<double>(own.complete_rounds);
  }
  if (rounds > 0.0) {
    facts.rows.emplace_back("Circular triads",
                            fmt::format("{:.2f} per complete round, over {} rounds", triads / rounds, rounds));
  }
  section.blocks.emplace_back(std::move(facts));
  section.blocks.emplace_back(fraction_curve(e, people));
  section.blocks.emplace_back(pair_curve(e, people));
  auto similarity = perception_plots::similarity_plot(e, perception_plots::methods_of_figure_13(true), &people);
  similarity.title = "Relative similarity by each method and by people (figure 13)";
  section.blocks.emplace_back(std::move(similarity));
  Table agreement;
  agreement.caption =
      "Rank correlation of every method with the scale: 95 % interval, and the chance of as much without any.";
  agreement.columns = {"method", "Spearman's rho", "Kendall's tau"};
  for (const auto& own : people.agreement) {
    agreement.rows.push_back(
        {{text_cell(own.method), text_cell(own.remark.empty() ? with_interval(own.spearman) : own.remark),
          text_cell(own.remark.empty() ? with_interval(own.kendall) : "")},
         "",
         {}});
  }
  section.blocks.emplace_back(std::move(agreement));
  return section;
}

}  // namespace touchstone::report
