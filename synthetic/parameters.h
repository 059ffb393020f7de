// Parameters of generators: declared with unit, range and default; values are read by name and checked, so that a
// misspelt or impossible one is refused with what was expected.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::synthetic {

struct Parameter {
  std::string name;  // carries its unit: radius_m
  std::string unit;  // "m", "1", "rad"
  double minimum;    // inclusive
  double maximum;    // inclusive
  double initial;    // the default
  std::string meaning;
};

// What a caller sets; what is absent takes its default.
using ParameterOverrides = std::map<std::string, double, std::less<>>;

// The values a generator runs with: the declared defaults with the overrides put over them.
class ParameterValues {
 public:
  // Throws UsageError naming `owner`, the parameter, its value and the range or the names that are known.
  ParameterValues(std::string owner, std::span<const Parameter> declared, const ParameterOverrides& overrides);

  // The value of a declared parameter; asking for an undeclared one is a programming error (std::out_of_range).
  [[nodiscard]] double operator[](std::string_view name) const;
  [[nodiscard]] std::size_t count(std::string_view name) const;  // rounded to an integer, at least 0
  [[nodiscard]] const std::map<std::string, double, std::less<>>& all() const noexcept { return values_; }

  // Throws UsageError with `owner` in front: for combinations that the ranges alone cannot rule out.
  [[noreturn]] void refuse(std::string_view message) const;

 private:
  std::string owner_;
  std::map<std::string, double, std::less<>> values_;
};

}  // namespace touchstone::synthetic
