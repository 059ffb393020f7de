// Making MetricResults: the one place where a value that is not a number becomes `missing` or `invalid` with its
// reason.
#pragma once

#include <string>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

// `value` where every one of the samples behind `from` was finite, else invalid with how many were not and the first.
MetricResult make_result(std::string name, std::string unit, std::string meaning, double value, const Moments& from);
// No number: nothing qualified, or the input is not there.
MetricResult make_missing(std::string name, std::string unit, std::string meaning, std::string why);
// Adds what to hold the value against; left out where it is not finite.
void set_reference(MetricResult& result, double reference, std::string meaning);

}  // namespace touchstone::metrics
