#include "harness/report/quantity.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

namespace touchstone::report {
namespace {

struct Step {
  std::string_view name;
  double at_least;  // in the base unit
  double factor;
};

constexpr std::array lengths{Step{"km", 1e3, 1e-3}, Step{"m", 1.0, 1.0}, Step{"mm", 1e-4, 1e3}, Step{"um", 1e-7, 1e6},
                             Step{"nm", 1e-12, 1e9}};
constexpr std::array forces{Step{"kN", 1e4, 1e-3}, Step{"N", 1e-2, 1.0}, Step{"mN", 1e-5, 1e3}, Step{"uN", 1e-9, 1e6}};
constexpr std::array times{Step{"s", 1.0, 1.0}, Step{"ms", 1e-3, 1e3}, Step{"us", 1e-9, 1e6}};
constexpr std::array costs{Step{"s", 1e6, 1e-6}, Step{"ms", 1e3, 1e-3}, Step{"us", 0.0, 1.0}};

}  // namespace

DisplayUnit display_unit(std::string_view unit, double largest) {
  std::span<const Step> steps;
  if (unit == "m") steps = lengths;
  if (unit == "N") steps = forces;
  if (unit == "s") steps = times;
  if (unit == "us") steps = costs;
  // Zero, what is not a number, and what is smaller than every unit (rounding) keep the unit as it is.
  if (!(std::abs(largest) > 0.0) || !std::isfinite(largest)) return {std::string(unit), 1.0};
  for (const Step& step : steps) {
    if (std::abs(largest) >= step.at_least) return {std::string(step.name), step.factor};
  }
  return {std::string(unit), 1.0};
}

std::string display_number(double value) {
  if (!std::isfinite(value)) return "not a number";
  if (value == 0.0) return "0";
  if (value == std::round(value) && std::abs(value) < 1e9) return fmt::format("{:.0f}", value);
  const double size = std::abs(value);
  if (size < 1e-3 || size >= 1e6) return fmt::format("{:.3e}", value);
  const int digits = std::max(0, 3 - static_cast<int>(std::floor(std::log10(size))));
  return fmt::format("{:.{}f}", value, digits);
}

std::string display_setting(double value, std::string_view unit) {
  const DisplayUnit chosen = display_unit(unit, value);
  return fmt::format("{:.4g}{}{}", value * chosen.factor, unit == "1" ? "" : " ", unit == "1" ? "" : chosen.name);
}

std::string display_quantity(double value, std::string_view unit) {
  const DisplayUnit chosen = display_unit(unit, value);
  const std::string number = display_number(value * chosen.factor);
  return unit == "1" || !std::isfinite(value) ? number : fmt::format("{} {}", number, chosen.name);
}

}  // namespace touchstone::report
