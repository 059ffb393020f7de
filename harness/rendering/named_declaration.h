// What model files may name beside renderers, contact effects and instrument entries, and what the catalogue says of
// each.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/parameters.h"

namespace touchstone::rendering {

struct NamedDeclaration {
  std::string name;
  std::string summary;
  std::vector<ParameterDeclaration> parameters;
  bool hypothesis = true;  // what may be missing from a model of a measurement: the search tries it
  EffectTraits traits = {};
};

struct NamedParameters;
// Finds the entry's name among the declared, or takes its own law, and checks its parameters; throws BadData with its
// place and what is known.
Parameters check_entry(const NamedParameters& entry, const std::vector<NamedDeclaration>& known, std::string_view what,
                       std::string_view source);

}  // namespace touchstone::rendering
