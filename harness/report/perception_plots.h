// What the parts of a perceptual report share: the colour of a condition, and the plot of figure 13.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "harness/perception/perceptual_evaluation.h"
#include "harness/perception/subjective_comparison.h"
#include "harness/report/page.h"

namespace touchstone::report::perception_plots {

inline constexpr std::array tones{Tone::rendered, Tone::error,     Tone::good,
                                  Tone::warning,  Tone::reference, Tone::neutral};

// An empty line for a row of the space: 0 is the real process. Colours repeat after six conditions; the second six are
// dashed.
Line line_of(const perception::PerceptualEvaluation& e, std::size_t row);

// Few enough to give each condition a line and a name.
bool few(const perception::PerceptualEvaluation& e);

// Indices from the least to the largest; what is not finite comes last.
std::vector<std::size_t> order_of(const std::vector<double>& cost);

// The methods of the paper's own figure 13 (its table 3 and the perception space), or the others.
std::vector<perception::Method> methods_of_figure_13(bool of_the_paper);

// Figure 13, for some methods; `people` may be null.
LinePlot similarity_plot(const perception::PerceptualEvaluation& e, const std::vector<perception::Method>& methods,
                         const perception::SubjectiveComparison* people);

}  // namespace touchstone::report::perception_plots
