// Quantities for people: a unit that suits the size of the value, and as many digits as say something.
#pragma once

#include <string>
#include <string_view>

namespace touchstone::report {

struct DisplayUnit {
  std::string name;     // "mm"
  double factor = 1.0;  // times the value in the unit given
};

// The unit to show values of up to `largest` in: m becomes km, m, mm, um or nm; N becomes N, mN or uN; s becomes s, ms
// or us; us becomes us, ms or s. Any other unit stays.
DisplayUnit display_unit(std::string_view unit, double largest);

// Four significant digits without exponent where that is short; "not a number" where it is not finite.
std::string display_number(double value);
// "0.418 N", "12.3 um"; a count (unit "1") has no unit.
std::string display_quantity(double value, std::string_view unit);
// The same without trailing zeros, for what somebody chose: "0.5 mm".
std::string display_setting(double value, std::string_view unit);

}  // namespace touchstone::report
