// What a comparison with a baseline says. Only `equal` passes: a missing baseline, a NaN or another unit never does.
#pragma once

#include <cstdint>
#include <string_view>

namespace touchstone::golden {

// In rising order of what it says about the result, so that the worst of several is their maximum.
enum class Verdict : std::uint8_t {
  equal,    // within tolerance
  better,   // closer to the truth than the baseline by more than the stated band: news too, so it does not pass
  worse,    // beyond tolerance
  missing,  // no baseline, or a column that only one side has
  invalid,  // not comparable: NaN or infinity, another number of rows
};

std::string_view to_string(Verdict verdict) noexcept;
constexpr bool passes(Verdict verdict) noexcept { return verdict == Verdict::equal; }
constexpr Verdict worst(Verdict a, Verdict b) noexcept { return a < b ? b : a; }

}  // namespace touchstone::golden
