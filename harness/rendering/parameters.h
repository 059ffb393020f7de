// The values that a renderer or effect runs with: what it declares, overridden by what a model file sets. A name that
// nothing declares and a value out of range are errors with their place in the file.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

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

}  // namespace touchstone::rendering
