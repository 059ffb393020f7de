#include "harness/pipeline/evaluation/request.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/units.h"

namespace touchstone::pipeline {
namespace {

// "0.2 N" to 0.2 and "N".
std::pair<double, std::string_view> number_and_unit(std::string_view text, std::string_view what) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  if (error != std::errc{} || !std::isfinite(value) || value < 0.0 || unit.empty()) {
    throw UsageError(fmt::format("{}: \"{}\" is not a number >= 0 with a unit, such as 0.05N", what, text));
  }
  return {value, unit};
}

}  // namespace

double parse_force_N(std::string_view text, std::string_view what) {
  const auto [value, unit] = number_and_unit(text, what);
  const auto factor = si_factor(Dimension::force, unit);
  if (!factor) {
    throw UsageError(
        fmt::format("{}: \"{}\" is not a unit of force; known are {}", what, unit, known_units(Dimension::force)));
  }
  return value * *factor;
}

void apply_threshold(std::string_view text, EvaluationRequest& request) {
  const std::string_view unit = number_and_unit(text, "--threshold").second;
  if (si_factor(Dimension::force, unit)) {
    request.force_threshold_N = parse_force_N(text, "--threshold");
  } else {
    request.position_threshold_m = parse_length_m(text, "--threshold");
  }
}

}  // namespace touchstone::pipeline
