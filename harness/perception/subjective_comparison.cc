#include "harness/perception/subjective_comparison.h"

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone::perception {

Agreement agree(const std::string& method, const std::vector<double>& values, bool larger_is_better,
                const std::vector<double>& scale) {
  Agreement result{method, {}, {}, ""};
  if (scale.size() < 3) {
    result.remark = "a rank correlation needs at least three conditions";
    return result;
  }
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    result.remark = "the method has no value for some condition";
    return result;
  }
  auto likeness = values;
  if (!larger_is_better) {
    for (double& value : likeness) value = -value;
  }
  result.spearman = spearman(likeness, scale);
  result.kendall = kendall(likeness, scale);
  if (std::isnan(result.spearman.coefficient)) result.remark = "all conditions are equal";
  return result;
}

SubjectiveComparison compare_with_people(const PerceptualEvaluation& evaluation, const PairedComparisons& answers) {
  if (answers.conditions.size() != evaluation.conditions.size()) {
    throw BadData("the answers are about other conditions than the evaluation");
  }
  SubjectiveComparison result;
  result.fraction_preferred = answers.fraction_preferred();
  const Eigen::MatrixXd wins = answers.wins();
  for (Eigen::Index a = 0; a < wins.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < wins.cols(); ++b) {
      const double all = wins(a, b) + wins(b, a);
      if (all > 0.0)
        result.pairs.push_back({static_cast<std::size_t>(a), static_cast<std::size_t>(b), wins(a, b) / all, all});
    }
  }
  result.thurstone = thurstone_case_v(answers);
  result.bradley_terry = bradley_terry(answers);
  result.triads = circular_triads(answers);
  result.subjects = answers.subjects.size();
  result.answers = answers.answers.size();
  const auto add = [&](const Method& method) {
    result.agreement.push_back(agree(std::string(method.name), evaluation.values(method.name), method.larger_is_better,
                                     result.bradley_terry.value));
  };
  add(perception_space_method);
  for (const auto& method : statistical_methods()) add(method.method);
  return result;
}

}  // namespace touchstone::perception
