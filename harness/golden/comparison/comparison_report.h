// A comparison as a table for people, as JSON for programs, and as named numbers for measurements and histories.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "harness/golden/comparison/compare.h"

namespace touchstone::golden {

// The verdict, one line per quantity and gate, and the worst sample of each quantity that is beyond tolerance.
std::string to_table(const Comparison& comparison);
nlohmann::json to_json(const Comparison& comparison);
std::string to_json_text(const Comparison& comparison);

// force_rms_N, force_p99_N, force_max_N, ... per quantity, force_fx_rms_N, ... per column, contact_shift_s,
// drift_samples, tolerance_used. Only what is finite; nothing from a comparison that could not be made.
std::vector<std::pair<std::string, double>> metrics_of(const Comparison& comparison);

}  // namespace touchstone::golden
