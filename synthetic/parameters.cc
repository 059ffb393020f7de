#include "synthetic/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/known_names.h"

namespace touchstone::synthetic {

ParameterValues::ParameterValues(std::string owner, std::span<const Parameter> declared,
                                 const ParameterOverrides& overrides)
    : owner_(std::move(owner)) {
  for (const Parameter& parameter : declared) values_.emplace(parameter.name, parameter.initial);
  for (const auto& given : overrides) {
    const std::string& name = given.first;
    const double value = given.second;
    const auto found =
        std::find_if(declared.begin(), declared.end(), [&](const Parameter& p) { return p.name == name; });
    if (found == declared.end()) {
      std::vector<std::string> known;
      for (const Parameter& p : declared) known.push_back(p.name);
      refuse(unknown_name("parameter", name, known));
    }
    if (!(value >= found->minimum && value <= found->maximum)) {
      refuse(fmt::format("{} = {} {} is outside [{}, {}] ({})", name, value, found->unit, found->minimum,
                         found->maximum, found->meaning));
    }
    values_.find(name)->second = value;
  }
}

double ParameterValues::operator[](std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::out_of_range(fmt::format("{} declares no parameter '{}'", owner_, name));
  return found->second;
}

std::size_t ParameterValues::count(std::string_view name) const {
  return static_cast<std::size_t>(std::max(0.0, std::round((*this)[name])));
}

void ParameterValues::refuse(std::string_view message) const {
  throw UsageError(fmt::format("{}: {}", owner_, message));
}

}  // namespace touchstone::synthetic
