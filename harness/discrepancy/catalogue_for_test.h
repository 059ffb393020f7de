// For tests of the search: what the effects of the project's catalogue say of themselves, with declarations of the
// test.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "harness/rendering/named_declaration.h"
#include "harness/rendering/predictor.h"
#include "renderers/catalogue.h"

namespace touchstone::discrepancy {

inline rendering::EffectTraits traits_of(const std::string& name) {
  for (const auto* const list : {&renderers::effect_catalogue(), &renderers::instrument_declarations()}) {
    for (const auto& entry : *list) {
      if (entry.name == name) return entry.traits;
    }
  }
  throw std::logic_error("no effect " + name);
}

// Every hypothesis of the catalogue.
inline std::vector<rendering::Candidate> whole_catalogue() {
  std::vector<rendering::Candidate> all;
  for (const auto& entry : renderers::effect_catalogue()) {
    if (entry.hypothesis) all.push_back({entry.name, rendering::Side::contact, entry.parameters, entry.traits});
  }
  for (const auto& entry : renderers::instrument_declarations())
    all.push_back({entry.name, rendering::Side::instrument, entry.parameters, entry.traits});
  return all;
}

}  // namespace touchstone::discrepancy
