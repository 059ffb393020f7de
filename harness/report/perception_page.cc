#include "harness/report/perception_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/report/evaluation_page.h"
#include "harness/report/perception_plots.h"

namespace touchstone::report {
namespace {

using namespace perception_plots;
using perception::PerceptualEvaluation;

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

std::vector<std::size_t> ranks_of(const std::vector<double>& values, bool larger_is_better) {
  auto cost = values;
  if (larger_is_better) {
    for (double& c : cost) c = -c;
  }
  std::vector<std::size_t> rank(cost.size());
  const auto order = perception_plots::order_of(cost);
  for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r + 1;
  return rank;
}

// The real process, whose line comes first, is drawn last and broken: else what equals it would hide it.
void real_on_top(LinePlot& plot) {
  plot.lines.front().dashed = true;
  std::rotate(plot.lines.begin(), plot.lines.begin() + 1, plot.lines.end());
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
  for (const std::size_t c : perception_plots::order_of(e.values(perception::perception_space_method.name))) {
    const auto& own = e.conditions[c];
    Table::Row row;
    row.cells = {text_cell(own.name), number_cell(own.distance)};
    for (std::size_t m = 0; m < methods.size(); ++m) {
      auto cell = number_cell(own.statistics[m].value_or(std::nan("")));
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
  plot.half_width = e.space.dimensions >= 3;
  plot.height_px = 420;
  plot.note =
      "Lines lead from the real process to the conditions; they are as long as the distances, as far as these "
      "two axes show them.";
  const auto at = [&](Eigen::Index row) {
    return std::pair{e.space.coordinates(row, across), e.space.coordinates(row, up)};
  };
  if (!perception_plots::few(e)) {
    Line all{"conditions", {}, {}, Tone::rendered, false, true};
    for (Eigen::Index row = 1; row < e.space.coordinates.rows(); ++row) {
      for (const double gap : {0.0, std::nan("")}) {  // marks alone, not a path from one to the next
        all.x.push_back(at(row).first + gap);
        all.y.push_back(at(row).second + gap);
      }
    }
    plot.lines = {std::move(all), Line{"real", {at(0).first}, {at(0).second}, Tone::measured, false, true}};
    plot.note.clear();
    return plot;
  }
  for (Eigen::Index row = 0; row < e.space.coordinates.rows(); ++row) {
    Line line = perception_plots::line_of(e, static_cast<std::size_t>(row));
    line.x = {at(0).first, at(row).first};
    line.y = {at(0).second, at(row).second};
    line.markers = true;
    plot.lines.push_back(std::move(line));
  }
  real_on_top(plot);
  return plot;
}

Section space_section(const PerceptualEvaluation& e) {
  Section section{
      "Perception space",
      fmt::format("Haptic images of {} (eq 16), scaled by the rule '{}', principal components (eq 17-20): {} "
                  "of the variance. Distances by eq 21.",
                  fmt::join(e.features, ", "), perception::name_of(e.scaling),
                  fmt::format("{} {} {:.1f} %", e.space.dimensions,
                              e.space.dimensions == 1 ? "dimension explains" : "dimensions explain",
                              100.0 * e.space.explained_share)),
      {},
      false};
  if (e.space.dimensions >= 2) section.blocks.emplace_back(scatter(e, 0, 1));
  if (e.space.dimensions >= 3) section.blocks.emplace_back(scatter(e, 0, 2));
  if (e.conditions.size() >= 3) {  // of two the one is 1 and the other 0 by every method
    auto theirs = perception_plots::similarity_plot(e, perception_plots::methods_of_figure_13(true), nullptr);
    theirs.title = "Relative similarity of the conditions by each method (figure 13)";
    section.blocks.emplace_back(std::move(theirs));
    auto others = perception_plots::similarity_plot(e, perception_plots::methods_of_figure_13(false), nullptr);
    others.title = "The same by the other statistics";
    section.blocks.emplace_back(std::move(others));
  }
  Table table;
  table.caption = "How the ranking depends on the scaling of features, which the paper leaves open: distance (rank).";
  table.columns = {"scaling"};
  for (const auto& c : e.conditions) table.columns.push_back(c.name);
  if (perception_plots::few(e)) {
    for (const auto scaling : perception::feature_scalings) {
      const auto distances = perception::distances_with_scaling(e, scaling, e.explained_share_wanted);
      const auto ranks = ranks_of(distances, false);
      Table::Row row;
      row.cells = {text_cell(std::string(perception::name_of(scaling)))};
      for (std::size_t c = 0; c < distances.size(); ++c) {
        auto cell = number_cell(distances[c]);
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
  Table counts;
  counts.caption = "Pairs of conditions that a method orders otherwise than the perception space does";
  counts.columns = {"method", "pairs", "of"};
  Table table;
  table.caption = "The pairs whose ranks differ most";
  table.columns = {"method", "nearer in perception space", "nearer by the method", "deciding feature", "why"};
  for (const auto& m : perception::statistical_methods()) {
    const auto found =
        perception::disagreements(e, m.method.name, perception_plots::few(e) ? perception::disagreements_told : 5);
    counts.rows.push_back({{text_cell(std::string(m.method.title)), number_cell(static_cast<double>(found.pairs)),
                            number_cell(static_cast<double>(found.of))},
                           "",
                           {}});
    for (const auto& d : found.most) {
      table.rows.push_back(
          {{text_cell(std::string(m.method.name)), text_cell(e.conditions[d.nearer_in_space].name),
            text_cell(e.conditions[d.nearer_by_statistic].name), text_cell(d.feature), text_cell(d.why)},
           "",
           {}});
    }
  }
  if (table.rows.empty()) {
    section.blocks.emplace_back(
        TextBlock{"Every statistic ranks the conditions as the perception space does.", Tone::good});
  } else {
    section.blocks.emplace_back(std::move(counts));
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
  plot.height_px = 300;
  return plot;
}

Section signal_section(const PerceptualEvaluation& e) {
  Section section{"Signals", "Along the direction of pressing, on the real process's clock.", {}, false};
  const double step = 1.0 / e.rate_Hz;
  auto force = series_plot("Force (figures 2 and 5)", "force [N]");
  auto felt = series_plot("Force as it is felt: output band and dead band (figure 6)", "force [N]");
  auto displacement = series_plot("Displacement (figure 2)", "displacement [m]");
  for (std::size_t row = 0; row < e.rendered_N.size(); ++row) {
    Line line = perception_plots::line_of(e, row);
    Line other = line;
    Line third = line;
    thin(line, e.rendered_N[row], step);
    thin(other, e.images[row].felt_force.held, step);
    thin(third, e.rendered_displacement_m[row], step);
    force.lines.push_back(std::move(line));
    felt.lines.push_back(std::move(other));
    displacement.lines.push_back(std::move(third));
  }
  for (auto* const plot : {&force, &felt, &displacement}) real_on_top(*plot);
  auto velocity = series_plot("Velocity of the real process (figure 2)", "velocity [m/s]");
  Line line = perception_plots::line_of(e, 0);
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
        {{text_cell(own.name), percent(own.force_reduction), percent(own.displacement_reduction),
          percent(own.guarded_share), number_cell(own.extended_rate_hardness_N_per_m.value_or(std::nan(""))),
          number_cell(own.harmonic_share)},
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
    const bool spectrum = block.step_Hz > 0.0;
    LinePlot plot;
    plot.height_px = 300;
    plot.title = block.name + (spectrum ? " (figure 10)" : block.name.ends_with("rate") ? " (figure 7)" : "");
    plot.x_label = spectrum ? "frequency [Hz]" : "time [s]";
    plot.y_label = fmt::format("{} [{}]", block.name, block.unit);
    for (std::size_t row = 0; row < e.images.size(); ++row) {
      Line line = perception_plots::line_of(e, row);
      line.y = e.images[row].blocks[f].values;
      for (std::size_t i = 0; i < line.y.size(); ++i) {
        const auto at = static_cast<double>(i);
        line.x.push_back(spectrum ? block.step_Hz * at : duration * (at + 0.5) / static_cast<double>(line.y.size()));
      }
      plot.lines.push_back(std::move(line));
    }
    real_on_top(plot);
    section.blocks.emplace_back(std::move(plot));
  }
  if (e.windows.empty()) return section;
  // A press or two: over more of them the lines are a band of ink.
  const std::size_t shown = std::min<std::size_t>(2000, e.samples);
  const std::vector<double> force_N(e.rendered_N[0].begin(),
                                    e.rendered_N[0].begin() + static_cast<std::ptrdiff_t>(shown));
  const std::vector<double> displacement_m(e.rendered_displacement_m[0].begin(),
                                           e.rendered_displacement_m[0].begin() + static_cast<std::ptrdiff_t>(shown));
  LinePlot plot;
  plot.title = fmt::format("Rate-hardness of the real process by window (figure 8), the first {} samples", shown);
  plot.x_label = "time [s]";
  plot.y_label = "rate-hardness [N/m]";
  plot.height_px = 340;
  Table table;
  table.caption = "A larger window is quieter and coarser.";
  table.columns = {"window [samples]", "duration [s]", "resolution [m]", "level [N/m]", "noise [N/m]", "guarded"};
  for (std::size_t w = 0; w < e.windows.size(); ++w) {
    const auto& own = e.windows[w];
    Line line;
    line.name = fmt::format("{} samples", own.window);
    line.tone = perception_plots::tones[w % perception_plots::tones.size()];
    if (own.window < shown)
      thin(line, perception::rate_hardness(force_N, displacement_m, own.window).values_N_per_m, 1.0 / e.rate_Hz);
    plot.lines.push_back(std::move(line));
    table.rows.push_back({{number_cell(static_cast<double>(own.window)),
                           number_cell(own.duration_s),
                           number_cell(own.resolution_m),
                           number_cell(own.level_N_per_m),
                           number_cell(own.noise_N_per_m),
                           {fmt::format("{:.1f} %", 100.0 * own.guarded_share), true, Tone::neutral}},
                          "",
                          {}});
  }
  section.blocks.emplace_back(std::move(plot));
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

std::vector<Section> perception_result_sections(const PerceptualEvaluation& evaluation) {
  return {ranking_section(evaluation), space_section(evaluation), disagreement_section(evaluation)};
}

std::vector<Section> perception_signal_sections(const PerceptualEvaluation& evaluation) {
  if (evaluation.rendered_N.empty()) return {};
  return {signal_section(evaluation), feature_section(evaluation)};
}

Page perception_page(const std::string& title, const PerceptualEvaluation& evaluation,
                     const perception::SubjectiveComparison* people, const Provenance& provenance) {
  Page page;
  page.title = title;
  page.subtitle =
      "Perceptual evaluation after Shao, Wu and Ouyang: what a person would feel, and what plain statistics say";
  const auto order = perception_plots::order_of(evaluation.values(perception::perception_space_method.name));
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

}  // namespace touchstone::report
