#include "harness/report/perception_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "harness/report/evaluation_page.h"

namespace touchstone {
namespace {

using perception::PerceptualEvaluation;

constexpr std::array kTones{Tone::rendered, Tone::error, Tone::good, Tone::warning, Tone::reference, Tone::neutral};

// Colours repeat after six conditions; the second six are dashed.
Line line_of(const PerceptualEvaluation& e, std::size_t row) {
  Line line;
  line.name = row == 0 ? "real" : e.conditions[row - 1].name;
  line.tone = row == 0 ? Tone::measured : kTones[(row - 1) % kTones.size()];
  line.dashed = row > kTones.size();
  return line;
}

// At most about 2000 points: of each stretch its smallest and largest value, so that steps and peaks stay.
void thin(Line& line, const std::vector<double>& y, double step) {
  const std::size_t stretch = y.size() <= 2000 ? 1 : y.size() / 1000;
  for (std::size_t first = 0; first < y.size(); first += stretch) {
    const auto begin = y.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = y.begin() + static_cast<std::ptrdiff_t>(std::min(first + stretch, y.size()));
    auto [low, high] = std::minmax_element(begin, end);
    if (high < low) std::swap(low, high);
    for (const auto at : {low, high}) {
      if (at == high && low == high) break;
      line.x.push_back(step * static_cast<double>(at - y.begin()));
      line.y.push_back(*at);
    }
    if (low == high) {
      line.x.push_back(step * static_cast<double>(low - y.begin()));
      line.y.push_back(*low);
    }
  }
}

Table::Cell text(std::string value) { return {std::move(value), false, Tone::neutral}; }
Table::Cell number(double value, int digits = 4) {
  return {std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : "none", true, Tone::neutral};
}

std::vector<std::size_t> order_of(const std::vector<double>& cost) {
  std::vector<std::size_t> order(cost.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::isfinite(cost[a]) && (!std::isfinite(cost[b]) || cost[a] < cost[b]);
  });
  return order;
}

std::vector<std::size_t> ranks_of(const std::vector<double>& values, bool larger_is_better) {
  auto cost = values;
  if (larger_is_better) {
    for (double& c : cost) c = -c;
  }
  std::vector<std::size_t> rank(cost.size());
  const auto order = order_of(cost);
  for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r + 1;
  return rank;
}

Section ranking_section(const PerceptualEvaluation& e) {
  Section section{
      "Ranking",
      "Nearest to the real process first, in perception space; beside it what plain statistics of the force say, "
      "each with its own rank in brackets.",
      {},
      false};
  Table table;
  table.columns = {"condition", "distance in perception space"};
  const auto& methods = perception::statistical_methods();
  std::vector<std::vector<std::size_t>> ranks;
  for (const auto& m : methods) {
    table.columns.push_back(fmt::format("{} [{}]", m.method.title, m.method.unit));
    ranks.push_back(ranks_of(e.values(m.method.name), m.method.larger_is_better));
  }
  for (const std::size_t c : order_of(e.values(perception::kPerceptionSpaceMethod.name))) {
    const auto& own = e.conditions[c];
    Table::Row row;
    row.cells = {text(own.name), number(own.distance)};
    for (std::size_t m = 0; m < methods.size(); ++m) {
      auto cell = number(own.statistics[m].value_or(std::nan("")));
      cell.text += fmt::format(" ({})", ranks[m][c]);
      if (ranks[m][c] != own.rank_perception) cell.tone = Tone::warning;
      row.cells.push_back(cell);
    }
    row.detail = "made of";
    for (std::size_t f = 0; f < e.features.size(); ++f) {
      row.detail += fmt::format("{} {} {:.3g}", f == 0 ? "" : ",", e.features[f], own.block_distance[f]);
    }
    row.detail += fmt::format(" (before the components beyond {} were left out)", e.space.dimensions);
    table.rows.push_back(std::move(row));
  }
  table.caption = "A figure set apart has another rank than in perception space.";
  section.blocks.emplace_back(std::move(table));
  for (const auto& remark : e.remarks) section.blocks.emplace_back(TextBlock{remark, Tone::warning});
  return section;
}

LinePlot scatter(const PerceptualEvaluation& e, Eigen::Index across, Eigen::Index up) {
  LinePlot plot;
  plot.title = fmt::format("Perception space, x{} and x{}", across + 1, up + 1);
  plot.x_label = fmt::format("x{}", across + 1);
  plot.y_label = fmt::format("x{}", up + 1);
  plot.half_width = true;
  plot.height_px = 380;
  for (Eigen::Index row = 0; row < e.space.coordinates.rows(); ++row) {
    Line line = line_of(e, static_cast<std::size_t>(row));
    // From the real process to the condition: its length is the distance, as far as these two axes show it.
    line.x = {e.space.coordinates(0, across), e.space.coordinates(row, across)};
    line.y = {e.space.coordinates(0, up), e.space.coordinates(row, up)};
    line.markers = true;
    plot.lines.push_back(std::move(line));
  }
  return plot;
}

Section space_section(const PerceptualEvaluation& e) {
  Section section{
      "Perception space",
      fmt::format("Haptic images of {} (eq 16), scaled by the rule '{}', principal components (eq 17-20): {} "
                  "dimensions explain {:.1f} % of the variance. Distances by eq 21.",
                  fmt::join(e.features, ", "), perception::name_of(e.scaling), e.space.dimensions,
                  100.0 * e.space.explained_share),
      {},
      false};
  if (e.space.dimensions >= 2) section.blocks.emplace_back(scatter(e, 0, 1));
  if (e.space.dimensions >= 3) section.blocks.emplace_back(scatter(e, 0, 2));
  if (e.conditions.size() >= 2) {
    LinePlot plot;
    plot.title = "Relative similarity of the conditions by each method (figure 13)";
    plot.x_label = "condition, in the order of the perception space";
    plot.y_label = "relative similarity, 1 is the best";
    const auto order = order_of(e.values(perception::kPerceptionSpaceMethod.name));
    std::size_t tone = 0;
    const auto add = [&](const perception::Method& method) {
      const auto similarity = perception::relative_similarity(e.values(method.name), method.larger_is_better);
      Line line;
      line.name = std::string(method.name);
      line.tone = kTones[tone % kTones.size()];
      line.dashed = tone >= kTones.size();
      line.markers = true;
      ++tone;
      for (std::size_t i = 0; i < order.size(); ++i) {
        line.x.push_back(static_cast<double>(i + 1));
        line.y.push_back(similarity[order[i]]);
      }
      plot.lines.push_back(std::move(line));
    };
    add(perception::kPerceptionSpaceMethod);
    for (const auto& m : perception::statistical_methods()) add(m.method);
    std::string names;
    for (std::size_t i = 0; i < order.size(); ++i) {
      names += fmt::format("{}{}: {}", i == 0 ? "" : ", ", i + 1, e.conditions[order[i]].name);
    }
    plot.note = names;
    section.blocks.emplace_back(std::move(plot));
  }
  Table table;
  table.caption = "How the ranking depends on the scaling of features, which the paper leaves open: distance (rank).";
  table.columns = {"scaling"};
  for (const auto& c : e.conditions) table.columns.push_back(c.name);
  if (e.conditions.size() <= perception::kKeepSeriesUpTo) {
    for (const auto scaling : perception::kFeatureScalings) {
      const auto distances = perception::distances_with_scaling(e, scaling, e.explained_share_wanted);
      const auto ranks = ranks_of(distances, false);
      Table::Row row;
      row.cells = {text(std::string(perception::name_of(scaling)))};
      for (std::size_t c = 0; c < distances.size(); ++c) {
        auto cell = number(distances[c]);
        cell.text += fmt::format(" ({})", ranks[c]);
        if (ranks[c] != e.conditions[c].rank_perception) cell.tone = Tone::warning;
        row.cells.push_back(cell);
      }
      table.rows.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section disagreement_section(const PerceptualEvaluation& e) {
  Section section{"Where statistics disagree, and why", "", {}, false};
  Table table;
  table.columns = {"method", "nearer in perception space", "nearer by the method", "deciding feature", "why"};
  for (const auto& m : perception::statistical_methods()) {
    for (const auto& d : perception::disagreements(e, m.method.name)) {
      table.rows.push_back({{text(std::string(m.method.name)), text(e.conditions[d.nearer_in_space].name),
                             text(e.conditions[d.nearer_by_statistic].name), text(d.feature), text(d.why)},
                            "",
                            {}});
    }
  }
  if (table.rows.empty()) {
    section.blocks.emplace_back(
        TextBlock{"Every statistic ranks the conditions as the perception space does.", Tone::good});
  } else {
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

LinePlot series_plot(const std::string& title, const std::string& y_label) {
  LinePlot plot;
  plot.title = title;
  plot.x_label = "time [s]";
  plot.y_label = y_label;
  plot.link = "time";
  return plot;
}

Section signal_section(const PerceptualEvaluation& e) {
  Section section{"Signals", "Along the direction of pressing, on the real process's clock.", {}, false};
  const double step = 1.0 / e.rate_Hz;
  auto force = series_plot("Force (figure 5)", "force [N]");
  auto felt = series_plot("Force as it is felt: output band and dead band (figure 6)", "force [N]");
  auto displacement = series_plot("Displacement", "displacement [m]");
  for (std::size_t row = 0; row < e.rendered_N.size(); ++row) {
    Line line = line_of(e, row);
    Line other = line;
    Line third = line;
    thin(line, e.rendered_N[row], step);
    thin(other, e.images[row].felt_force.held, step);
    thin(third, e.rendered_displacement_m[row], step);
    force.lines.push_back(std::move(line));
    felt.lines.push_back(std::move(other));
    displacement.lines.push_back(std::move(third));
  }
  auto velocity = series_plot("Velocity of the real process (figure 2)", "velocity [m/s]");
  Line line = line_of(e, 0);
  thin(line, perception::derivative(e.rendered_displacement_m[0], e.rate_Hz, 5), step);
  velocity.lines.push_back(std::move(line));
  section.blocks = {std::move(force), std::move(felt), std::move(displacement), std::move(velocity)};
  Table table;
  table.caption = "Data reduction of the dead band and one number of each press.";
  table.columns = {"process",
                   "force samples not kept",
                   "displacement samples not kept",
                   "rate-hardness guarded",
                   "extended rate-hardness (eq 5) [N/m]",
                   "harmonic share of the spectrum"};
  const auto add = [&table](const perception::ConditionResult& own) {
    const auto percent = [](double share) {
      return Table::Cell{fmt::format("{:.2f} %", 100.0 * share), true, Tone::neutral};
    };
    table.rows.push_back(
        {{text(own.name), percent(own.force_reduction), percent(own.displacement_reduction), percent(own.guarded_share),
          number(own.extended_rate_hardness_N_per_m.value_or(std::nan(""))), number(own.harmonic_share)},
         "",
         {}});
  };
  add(e.real);
  for (const auto& c : e.conditions) add(c);
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section feature_section(const PerceptualEvaluation& e) {
  Section section{"Features", "As they enter the haptic image, before scaling.", {}, false};
  const double duration = static_cast<double>(e.samples) / e.rate_Hz;
  for (std::size_t f = 0; f < e.features.size(); ++f) {
    const auto& block = e.images.front().blocks[f];
    const bool spectrum = block.name.find("spectrum") != std::string::npos;
    LinePlot plot;
    plot.title = spectrum ? block.name + " (figure 10)" : block.name;
    plot.x_label = spectrum ? "band" : "time [s]";
    plot.y_label = fmt::format("{} [{}]", block.name, block.unit);
    for (std::size_t row = 0; row < e.images.size(); ++row) {
      Line line = line_of(e, row);
      line.y = e.images[row].blocks[f].values;
      for (std::size_t i = 0; i < line.y.size(); ++i) {
        const auto at = static_cast<double>(i);
        line.x.push_back(spectrum ? at : duration * (at + 0.5) / static_cast<double>(line.y.size()));
      }
      plot.lines.push_back(std::move(line));
    }
    section.blocks.emplace_back(std::move(plot));
  }
  if (e.windows.empty()) return section;
  auto plot = series_plot("Rate-hardness of the real process by window (figure 8)", "rate-hardness [N/m]");
  Table table;
  table.caption = "A larger window is quieter and coarser.";
  table.columns = {"window [samples]", "duration [s]", "resolution [m]", "level [N/m]", "noise [N/m]", "guarded"};
  for (std::size_t w = 0; w < e.windows.size(); ++w) {
    const auto& own = e.windows[w];
    Line line;
    line.name = fmt::format("{} samples", own.window);
    line.tone = kTones[w % kTones.size()];
    thin(line, perception::rate_hardness(e.rendered_N[0], e.rendered_displacement_m[0], own.window).values_N_per_m,
         1.0 / e.rate_Hz);
    plot.lines.push_back(std::move(line));
    table.rows.push_back({{number(static_cast<double>(own.window)),
                           number(own.duration_s),
                           number(own.resolution_m),
                           number(own.level_N_per_m),
                           number(own.noise_N_per_m),
                           {fmt::format("{:.1f} %", 100.0 * own.guarded_share), true, Tone::neutral}},
                          "",
                          {}});
  }
  section.blocks.emplace_back(std::move(plot));
  section.blocks.emplace_back(std::move(table));
  return section;
}

std::string with_interval(const perception::RankCorrelation& own) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f}), p = {:.3f}", own.coefficient, own.low95, own.high95, own.p_two_sided);
}

}  // namespace

std::vector<Section> perception_result_sections(const PerceptualEvaluation& evaluation) {
  return {ranking_section(evaluation), space_section(evaluation), disagreement_section(evaluation)};
}

std::vector<Section> perception_signal_sections(const PerceptualEvaluation& evaluation) {
  if (evaluation.rendered_N.empty()) return {};
  return {signal_section(evaluation), feature_section(evaluation)};
}

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
    scales.rows.push_back({{text(e.conditions[c].name),
                            number(people.fraction_preferred[c], 3),
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
  LinePlot curve;
  curve.title = "Fraction preferred over the psychological scale (figure 12)";
  curve.x_label = "psychological scale (Bradley-Terry)";
  curve.y_label = "fraction preferred";
  Line points;
  points.name = "observed";
  points.tone = Tone::measured;
  points.markers = true;
  Line model;
  model.name = "expected by the model";
  model.tone = Tone::rendered;
  model.dashed = true;
  model.markers = true;
  auto cost = people.bradley_terry.value;
  for (const std::size_t c : order_of(cost)) {
    points.x.push_back(people.bradley_terry.value[c]);
    points.y.push_back(people.fraction_preferred[c]);
    model.x.push_back(people.bradley_terry.value[c]);
    model.y.push_back(perception::expected_fraction_of(people.bradley_terry, c));
  }
  curve.lines = {std::move(points), std::move(model)};
  section.blocks.emplace_back(std::move(curve));
  Table agreement;
  agreement.caption =
      "Rank correlation of every method with the scale: 95 % interval, and the chance of as much without any.";
  agreement.columns = {"method", "Spearman's rho", "Kendall's tau"};
  for (const auto& own : people.agreement) {
    agreement.rows.push_back({{text(own.method), text(own.remark.empty() ? with_interval(own.spearman) : own.remark),
                               text(own.remark.empty() ? with_interval(own.kendall) : "")},
                              "",
                              {}});
  }
  section.blocks.emplace_back(std::move(agreement));
  return section;
}

Page perception_page(const std::string& title, const PerceptualEvaluation& evaluation,
                     const perception::SubjectiveComparison* people, const Provenance& provenance) {
  Page page;
  page.title = title;
  page.subtitle =
      "Perceptual evaluation after Shao, Wu and Ouyang: what a person would feel, and what plain statistics say";
  const auto order = order_of(evaluation.values(perception::kPerceptionSpaceMethod.name));
  const auto& best = evaluation.conditions[order.front()];
  page.headlines = {
      {"nearest to the real process", best.name, "", fmt::format("distance {:.4g}", best.distance), Tone::good},
      {"conditions", fmt::format("{}", evaluation.conditions.size()), "", "", Tone::neutral},
      {"dimensions", fmt::format("{}", evaluation.space.dimensions), "",
       fmt::format("{:.1f} % explained", 100.0 * evaluation.space.explained_share), Tone::neutral}};
  page.sections = perception_result_sections(evaluation);
  if (people != nullptr) page.sections.push_back(agreement_section(evaluation, *people));
  for (auto& section : perception_signal_sections(evaluation)) page.sections.push_back(std::move(section));
  page.sections.push_back(provenance_section(provenance));
  return page;
}

}  // namespace touchstone
