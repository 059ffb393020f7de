// How sure a verdict of perception space is: whether what was measured again lies nearer to the real process than
// renderings do, under every rule that scales features, in the space that explains 90 % and in the whole one. Where
// conditions are few the former may leave out the very axis along which the near ones differ.
#pragma once

#include <string>
#include <vector>

#include "harness/perception/perceptual_evaluation.h"
#include "harness/report/page.h"

namespace touchstone::experiments {

struct Nearness {
  perception::FeatureScaling scaling;
  double explained_share;               // asked for: 0.9, or 1 for all components
  std::vector<double> median_distance;  // by condition, over the comparisons
  std::vector<std::size_t> nearer;      // by condition: in how many comparisons condition 0 is nearer than it
  std::size_t compared;
};

// Of comparisons with the same conditions in the same order, the one measured again first. Throws BadData for none, or
// where their numbers of conditions differ.
std::vector<Nearness> nearness(const std::vector<const perception::PerceptualEvaluation*>& comparisons);

report::Table nearness_table(const std::vector<Nearness>& rows, const std::vector<std::string>& conditions);

// Appends one comparison in full, its titles marked as those of the first pair.
void show_first_pair(report::Page& page, const perception::PerceptualEvaluation& first);

}  // namespace touchstone::experiments
