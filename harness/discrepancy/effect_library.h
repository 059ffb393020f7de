// The effects that a search knows, by name: what each says of itself, and which are special cases of which.
#pragma once

#include <string>
#include <vector>

#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// What is pointed to must outlive it.
class EffectLibrary {
 public:
  explicit EffectLibrary(const std::vector<rendering::Candidate>& candidates) : candidates_(&candidates) {}

  // Of an effect that is not in it: those of one that says nothing of itself.
  [[nodiscard]] const rendering::EffectTraits& traits(const std::string& name) const;

  // Whether `larger` has `smaller` as a special case: of two that do as well, the smaller is the finding; and one model
  // has not both.
  [[nodiscard]] bool contains(const std::string& larger, const std::string& smaller) const;
  // One contains the other, or both contain the same.
  [[nodiscard]] bool of_one_kind(const std::string& a, const std::string& b) const;
  [[nodiscard]] bool has_what_contains(const rendering::Model& model, const std::string& smaller) const;
  [[nodiscard]] rendering::Model without_special_cases(const rendering::Model& model, const std::string& larger) const;

 private:
  const std::vector<rendering::Candidate>* candidates_;
};

}  // namespace touchstone::discrepancy
