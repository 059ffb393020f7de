// Dimensions of units that a user writes, as powers of metre, second and newton: "N s^2/m^2" is N^1 s^2 m^-2. Formulas
// calculate in SI, so that units with a factor (mm, ms) are refused.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace touchstone::rendering {

struct UnitDimension {
  enum Base : std::size_t { metre, second, newton, count };
  std::array<int, count> powers{};
  bool operator==(const UnitDimension&) const = default;
};

// Factors separated by spaces or *, each with an optional power (^2, ^-1); all that follows the first / is divided by
// ("N s/m/rad"). Known: 1, rad, m, s, N, kg, Hz, J, W, Pa. Nothing for anything else.
std::optional<UnitDimension> dimension_of(std::string_view unit);

// For messages: "1, rad, m, s, N, kg, Hz, J, W, Pa".
std::string known_base_units();

}  // namespace touchstone::rendering
