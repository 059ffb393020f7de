// The metrics of one or several evaluations as a table for a terminal.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "harness/metrics/metric.h"

namespace touchstone::report {

// One column per named evaluation, one row per metric; every number with its unit, and why where there is none.
// All evaluations list the same metrics; throws UsageError naming one that does not.
std::string console_table(
    const std::vector<std::pair<std::string, const std::vector<metrics::MetricResult>*>>& evaluations);

// Columns aligned, numbers as given; the first row is the head.
std::string align_columns(const std::vector<std::vector<std::string>>& rows);

}  // namespace touchstone::report
