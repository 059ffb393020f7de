// Values at other times, on the straight line between their neighbours.
#pragma once

#include <string>
#include <vector>

namespace touchstone::importing {

// `values` at `clock`, at the times `at`; NaN before the first and after the last. Both clocks increase.
std::vector<double> interpolated_at(const std::vector<double>& clock, const std::vector<double>& values,
                                    const std::vector<double>& at);
// Where `values` has none between two that it has, it gets the one in between; before the first and after the last it
// has none still.
void fill_missing(const std::vector<double>& clock, std::vector<double>& values);

}  // namespace touchstone::importing
