#include "harness/rendering/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/base/known_names.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/model.h"
#include "harness/rendering/named_declaration.h"

namespace touchstone::rendering {

Parameters::Parameters(const std::vector<ParameterDeclaration>& declared, const std::map<std::string, double>& given,
                       std::string_view owner, std::string_view source, std::string_view place) {
  std::vector<std::string> known;
  for (const auto& declaration : declared) {
    known.push_back(declaration.name);
    values_[declaration.name] = declaration.initial;
  }
  for (const auto& [name, value] : given) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw BadData(fmt::format("{}: {}/parameters/{}: nothing reads this parameter{}: {}", source, place, name,
                                line_in_file(std::string(source), fmt::format("{}/parameters/{}", place, name)),
                                unknown_name(fmt::format("parameter of the {} called", owner), name, known)));
    }
    const auto& declaration = declared[static_cast<std::size_t>(found - known.begin())];
    // Written so that NaN fails too.
    if (!(value >= declaration.minimum && value <= declaration.maximum)) {
      throw BadData(fmt::format("{}: {}/parameters/{}: {} is out of range; {} to {} {} is allowed ({})", source, place,
                                name, value, declaration.minimum, declaration.maximum, declaration.unit,
                                declaration.meaning));
    }
    values_[name] = value;
  }
}

double Parameters::at(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::logic_error(fmt::format("parameter {} is read but not declared", name));
  return found->second;
}

Parameters check_entry(const NamedParameters& entry, const std::vector<NamedDeclaration>& known, std::string_view what,
                       std::string_view source) {
  std::vector<std::string> names;
  for (const auto& declaration : known) {
    if (declaration.name == entry.name && entry.law != nullptr) {
      throw BadData(fmt::format("{}: {}/law: there is {} {} of this name; give the law a name of its own", source,
                                entry.place, what, entry.name));
    }
    if (declaration.name == entry.name) {
      return {declaration.parameters, entry.parameters, fmt::format("{} {}", what, entry.name), source, entry.place};
    }
    names.push_back(declaration.name);
  }
  if (entry.law != nullptr) {
    return {entry.law->parameters, entry.parameters, fmt::format("{} {}", what, entry.name), source, entry.place};
  }
  throw BadData(fmt::format("{}: {}/name: {}", source, entry.place, unknown_name(what, entry.name, names)));
}

}  // namespace touchstone::rendering
