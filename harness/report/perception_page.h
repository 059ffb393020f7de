// The report of a perceptual evaluation: ranking, perception space, where statistics disagree and why, how the ranking
// depends on the scaling, signals and features as in the figures of Shao, Wu and Ouyang.
#pragma once

#include <string>
#include <vector>

#include "harness/perception/perceptual_evaluation.h"
#include "harness/perception/subjective_comparison.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::report {

// `people` may be null.
Page perception_page(const std::string& title, const perception::PerceptualEvaluation& evaluation,
                     const perception::SubjectiveComparison* people, const Provenance& provenance);

// Parts of it, for reports that show more.
std::vector<Section> perception_result_sections(const perception::PerceptualEvaluation& evaluation);
std::vector<Section> perception_signal_sections(const perception::PerceptualEvaluation& evaluation);
Section agreement_section(const perception::PerceptualEvaluation& evaluation,
                          const perception::SubjectiveComparison& people);

}  // namespace touchstone::report
