#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "harness/renderer_faults/scorecard.h"

namespace touchstone::renderer_faults {
namespace {

// Not std::max: it drops a NaN, and what is no number must show.
double larger(double a, double b) { return std::isnan(a) || a > b ? a : b; }

// Two digits, and no exponent where people count in per cent.
std::string in_percent(double share) {
  return share >= 99.5                 ? fmt::format("{:.0f}", share)
         : share < 1e-3 && share > 0.0 ? "<0.001"
                                       : fmt::format("{:.2g}", share);
}

// Cases of one shape differ in size, and their forces with it: each error is a share of its case's largest right force.
// The mean is over all samples of the shape, the largest error and the largest jump are those of the worst case.
std::string shape_cell(const Scorecard& card, const std::string& shape) {
  double samples = 0.0;
  double mean = 0.0;
  double most = 0.0;
  double jump = 0.0;
  std::string problem;
  for (const CaseScore& one : card.cases) {
    if (one.shape != shape) continue;
    if (!one.problem.empty()) {
      // A case that could not run outweighs one that says nothing about the engine.
      if (!one.skipped) return "could not run ";
      problem = "skipped ";
      continue;
    }
    const double share = one.right_N > 0.0 ? 100.0 / one.right_N : std::numeric_limits<double>::quiet_NaN();
    const auto count = static_cast<double>(one.samples);
    samples += count;
    mean += count * share * one.mean_N;
    most = larger(most, share * one.max_N);
    jump = larger(jump, share * one.jump_N);
  }
  if (samples == 0.0) return problem;
  return fmt::format("{} / {} / {} ", in_percent(mean / samples), in_percent(most), in_percent(jump));
}

std::string faults_cell(const Scorecard& card) {
  std::string names;
  for (const Finding& finding : card.diagnosis.findings) names += (names.empty() ? "" : ", ") + finding.name;
  return (names.empty() ? "none" : names) + " ";
}

}  // namespace

std::string scorecard_to_markdown(const std::vector<Scorecard>& cards) {
  std::string table;
  const auto row = [&](const std::string& head, const auto& cell) {
    table += "| " + head + " |";
    for (const Scorecard& card : cards) table += " " + cell(card) + "|";
    table += "\n";
  };
  row("shape", [](const Scorecard& card) { return card.engine + " "; });
  table += "|---|";
  for (std::size_t i = 0; i < cards.size(); ++i) table += "---|";
  table += "\n";
  std::vector<std::string> shapes;
  for (const Scorecard& card : cards) {
    for (const CaseScore& one : card.cases) {
      if (std::ranges::find(shapes, one.shape) == shapes.end()) shapes.push_back(one.shape);
    }
  }
  for (const std::string& shape : shapes) row(shape, [&](const Scorecard& card) { return shape_cell(card, shape); });
  row("faults", faults_cell);
  return table;
}

}  // namespace touchstone::renderer_faults
