#include "harness/report/perception_plots.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchstone::report::perception_plots {

using perception::PerceptualEvaluation;

Line line_of(const PerceptualEvaluation& e, std::size_t row) {
  Line line;
  line.name = row == 0 ? "real" : e.conditions[row - 1].name;
  line.tone = row == 0 ? Tone::measured : tones[(row - 1) % tones.size()];
  line.dashed = row > tones.size();
  return line;
}

bool few(const PerceptualEvaluation& e) { return e.conditions.size() <= perception::keep_series_up_to; }

std::vector<std::size_t> order_of(const std::vector<double>& cost) {
  std::vector<std::size_t> order(cost.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::isfinite(cost[a]) && (!std::isfinite(cost[b]) || cost[a] < cost[b]);
  });
  return order;
}

LinePlot similarity_plot(const PerceptualEvaluation& e, const std::vector<perception::Method>& methods,
                         const perception::SubjectiveComparison* people) {
  LinePlot plot;
  plot.x_label = "condition, in the order of the perception space";
  plot.y_label = "relative similarity, 1 is the best";
  plot.height_px = 380;
  const auto order = order_of(e.values(perception::perception_space_method.name));
  const auto add = [&](const std::string& name, const std::vector<double>& values, bool larger_is_better) {
    const auto similarity = perception::relative_similarity(values, larger_is_better);
    const std::size_t tone = plot.lines.size();
    Line line{name, {}, {}, tones[tone % tones.size()], tone >= tones.size(), few(e)};
    for (std::size_t i = 0; i < order.size(); ++i) {
      line.x.push_back(static_cast<double>(i + 1));
      line.y.push_back(similarity[order[i]]);
    }
    plot.lines.push_back(std::move(line));
  };
  for (const auto& m : methods) add(std::string(m.name), e.values(m.name), m.larger_is_better);
  if (people != nullptr) {
    add("people", people->bradley_terry.value, true);
    plot.lines.back().tone = Tone::measured;
  }
  for (std::size_t i = 0; few(e) && i < order.size(); ++i)
    plot.x_names.emplace_back(static_cast<double>(i + 1), e.conditions[order[i]].name);
  return plot;
}

std::vector<perception::Method> methods_of_figure_13(bool of_the_paper) {
  std::vector<perception::Method> methods;
  if (of_the_paper) methods.push_back(perception::perception_space_method);
  for (const auto& m : perception::statistical_methods()) {
    const bool theirs = m.method.name.starts_with("euclidean") || m.method.name.starts_with("pearson");
    if (theirs == of_the_paper) methods.push_back(m.method);
  }
  return methods;
}

}  // namespace touchstone::report::perception_plots
