#include "harness/report/json_numbers.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace touchstone::report {

nlohmann::json exact_number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json plotted_number(double value) {
  if (!std::isfinite(value)) return nullptr;
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 9).ptr;
  double rounded = 0.0;
  std::from_chars(text, end, rounded);
  return rounded;
}

nlohmann::json plotted_numbers(const std::vector<double>& values) {
  nlohmann::json out = nlohmann::json::array();
  for (const double value : values) out.push_back(plotted_number(value));
  return out;
}

}  // namespace touchstone::report
