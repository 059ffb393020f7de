// The report of the comparison on a real indentation, and its JSON, "touchstone-indentation/1".
#pragma once

#include <string>
#include <vector>

#include "experiments/indentation.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

// In how many pairs the record measured again is the nearest of all conditions.
std::size_t measured_nearest(const std::vector<IndentationComparison>& comparisons);

report::Page indentation_page(const Approach& approach, const std::vector<IndentationComparison>& comparisons,
                              const report::Provenance& provenance);
std::string indentation_to_json(const Approach& approach, const std::vector<IndentationComparison>& comparisons);

}  // namespace touchstone::experiments
