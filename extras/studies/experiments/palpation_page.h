// The report of compare_rows(): every pair of rows, and the pictures of one.
#pragma once

#include <string>
#include <vector>

#include "experiments/palpation_rows.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

report::Page palpation_page(const recording::Recording& recording, const std::vector<RowComparison>& comparisons,
                            const report::Provenance& provenance);
// "touchstone-palpation/1": the distances of every pair.
std::string palpation_to_json(const recording::Recording& recording, const std::vector<RowComparison>& comparisons);

}  // namespace touchstone::experiments
