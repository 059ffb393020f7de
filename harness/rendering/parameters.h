// The values that a renderer or effect runs with: what it declares, overridden by what a model file sets. A name that
// nothing declares and a value out of range are errors with their place in the file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

// What a renderer, effect or instrument entry may be called and set to.
struct NamedDeclaration {
  std::string name;
  std::string summary;
  std::vector<ParameterDeclaration> parameters;
  bool hypothesis = true;  // what may be missing from a model of a measurement: the search tries it
  EffectTraits traits = {};
};

class Parameters {
 public:
  // `owner` is for messages ("renderer god-object"), `source` the file, `place` the JSON pointer of the object that
  // holds "parameters" ("" for the root). Throws BadData.
  Parameters(const std::vector<ParameterDeclaration>& declared, const std::map<std::string, double>& given,
             std::string_view owner, std::string_view source, std::string_view place);

  // The value of a declared parameter; asking for one that is not declared is a mistake of the program (logic_error).
  [[nodiscard]] double at(std::string_view name) const;
  [[nodiscard]] const std::map<std::string, double, std::less<>>& values() const noexcept { return values_; }

 private:
  std::map<std::string, double, std::less<>> values_;
};

struct NamedParameters;
// Finds the entry's name among the declared, or takes its own law, and checks its parameters; throws BadData with its
// place and what is known.
Parameters check_entry(const NamedParameters& entry, const std::vector<NamedDeclaration>& known, std::string_view what,
                       std::string_view source);

}  // namespace touchstone::rendering
