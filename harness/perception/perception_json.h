// A perceptual evaluation as JSON, "touchstone-perception/1": everything that the report shows, for programs.
#pragma once

#include <filesystem>
#include <string>

#include "harness/perception/perceptual_evaluation.h"
#include "harness/perception/subjective_comparison.h"

namespace touchstone::perception {

// `people` may be null. Values that are undefined are null.
std::string evaluation_to_json(const PerceptualEvaluation& evaluation, const SubjectiveComparison* people);

}  // namespace touchstone::perception
