#include "harness/rendering/unit_dimension.h"

#include <algorithm>
#include <charconv>

namespace touchstone::rendering {
namespace {

struct NamedUnit {
  std::string_view name;
  UnitDimension dimension;
};

constexpr std::array<NamedUnit, 10> units{{{"1", {{0, 0, 0}}},
                                           {"rad", {{0, 0, 0}}},
                                           {"m", {{1, 0, 0}}},
                                           {"s", {{0, 1, 0}}},
                                           {"N", {{0, 0, 1}}},
                                           {"kg", {{-1, 2, 1}}},
                                           {"Hz", {{0, -1, 0}}},
                                           {"J", {{1, 0, 1}}},
                                           {"W", {{1, -1, 1}}},
                                           {"Pa", {{-2, 0, 1}}}}};

constexpr std::string_view separators = " */";

// "s^2" times `sign`, added. False if it is not known.
bool add_factor(std::string_view factor, int sign, UnitDimension& sum) {
  int power = 1;
  if (const std::size_t hat = factor.find('^'); hat != std::string_view::npos) {
    const std::string_view digits = factor.substr(hat + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
    if (error != std::errc{} || end != digits.data() + digits.size()) return false;
    factor = factor.substr(0, hat);
  }
  const auto known = std::find_if(units.begin(), units.end(), [&](const NamedUnit& u) { return u.name == factor; });
  if (known == units.end()) return false;
  for (std::size_t i = 0; i < UnitDimension::count; ++i) sum.powers[i] += sign * power * known->dimension.powers[i];
  return true;
}

}  // namespace

std::optional<UnitDimension> dimension_of(std::string_view unit) {
  UnitDimension sum;
  int sign = 1;
  bool any = false;
  while (!unit.empty()) {
    if (separators.find(unit.front()) != std::string_view::npos) {
      if (unit.front() == '/') sign = -1;
      unit.remove_prefix(1);
      continue;
    }
    const std::size_t length = std::min(unit.find_first_of(separators), unit.size());
    if (!add_factor(unit.substr(0, length), sign, sum)) return std::nullopt;
    any = true;
    unit.remove_prefix(length);
  }
  return any ? std::optional(sum) : std::nullopt;
}

std::string known_base_units() {
  std::string names;
  for (const NamedUnit& unit : units) names += (names.empty() ? "" : ", ") + std::string(unit.name);
  return names;
}

}  // namespace touchstone::rendering
