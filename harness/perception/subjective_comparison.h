// Objective methods held against people: the psychological scales of a set of answers, and how well every method ranks
// the conditions as the scale does (section 4, figure 12 and 13).
#pragma once

#include <string>
#include <vector>

#include "harness/perception/agreement.h"
#include "harness/perception/perceptual_evaluation.h"
#include "harness/perception/subjective/paired_comparisons.h"
#include "harness/perception/subjective/psychological_scale.h"

namespace touchstone::perception {

struct Agreement {
  std::string method;
  RankCorrelation spearman;  // +1: the method ranks as people do
  RankCorrelation kendall;
  std::string remark;  // why there is no number
};

// Rank correlations of a method's values with the scale (larger: more like the real process). `larger_is_better` turns
// the sign of distances. Fewer than three conditions or an undefined value give a remark instead of numbers.
Agreement agree(const std::string& method, const std::vector<double>& values, bool larger_is_better,
                const std::vector<double>& scale);

struct PairShare {
  std::size_t a;
  std::size_t b;
  double a_chosen;  // share of the answers to this pair
  double answers;
};

struct SubjectiveComparison {
  std::vector<double> fraction_preferred;
  std::vector<PairShare> pairs;  // that were compared
  PsychologicalScale thurstone;
  PsychologicalScale bradley_terry;
  std::vector<CircularTriads> triads;
  std::size_t subjects = 0;
  std::size_t answers = 0;
  std::vector<Agreement> agreement;  // perception space first, then every statistic; with the Bradley-Terry scale
};

// The answers' conditions must be those of the evaluation, in its order (read_answers with its names); throws BadData
// if they are not.
SubjectiveComparison compare_with_people(const PerceptualEvaluation& evaluation, const PairedComparisons& answers);

}  // namespace touchstone::perception
