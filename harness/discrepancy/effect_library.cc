#include "harness/discrepancy/effect_library.h"

#include <algorithm>

#include "harness/discrepancy/free_parameter.h"
#include "harness/discrepancy/model_edit.h"

namespace touchstone::discrepancy {
using rendering::Model;

const rendering::EffectTraits& EffectLibrary::traits(const std::string& name) const {
  static const rendering::EffectTraits none;
  const auto found = std::ranges::find(*candidates_, name, &rendering::Candidate::name);
  return found == candidates_->end() ? none : found->traits;
}

bool EffectLibrary::contains(const std::string& larger, const std::string& smaller) const {
  const auto& names = traits(larger).contains;
  return std::ranges::find(names, smaller) != names.end();
}

bool EffectLibrary::of_one_kind(const std::string& a, const std::string& b) const {
  return contains(a, b) || contains(b, a) ||
         std::ranges::any_of(traits(a).contains, [&](const std::string& name) { return contains(b, name); });
}

bool EffectLibrary::has_what_contains(const Model& model, const std::string& smaller) const {
  return std::ranges::any_of(*candidates_, [&](const rendering::Candidate& candidate) {
    return contains(candidate.name, smaller) && find_entry(model, candidate.name) != nullptr;
  });
}

Model EffectLibrary::without_special_cases(const Model& model, const std::string& larger) const {
  Model rest = model;
  for (const std::string& name : traits(larger).contains) rest = without_entry(rest, name);
  return rest;
}

}  // namespace touchstone::discrepancy
