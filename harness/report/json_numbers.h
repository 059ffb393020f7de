// Numbers for plots in JSON: nine significant digits (more than any plot shows), null where there is no number.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace touchstone::report {

nlohmann::json plotted_number(double value);
nlohmann::json plotted_numbers(const std::vector<double>& values);
// Every digit; null where not finite.
nlohmann::json exact_number(double value);

}  // namespace touchstone::report
