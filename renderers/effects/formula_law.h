// The formulas of an effect that a user declared (harness/rendering/declared_effect.h), ready to be evaluated at every
// step, and the same as an effect of the contact.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/base/vec.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/effect.h"
#include "harness/rendering/effect_stack.h"
#include "harness/rendering/formula.h"

namespace touchstone::renderers {

// Stays where it was made: its formulas look their variables up in it.
class FormulaLaw {
 public:
  // `values`: of the parameters, in their order, already checked.
  FormulaLaw(const DeclaredEffect& effect, std::span<const double> values);
  FormulaLaw(const FormulaLaw&) = delete;
  FormulaLaw& operator=(const FormulaLaw&) = delete;

  // Where a variable's value is to be put before anything is evaluated. One that the law does not have throws
  // logic_error.
  [[nodiscard]] double* slot(std::string_view variable);

  // States at their start.
  void reset() noexcept;
  // States after a step of dt. Linearly implicit Euler (Rosenbrock 1963), each state with its own derivative by
  // differences: a state that follows another quantity far faster than the steps are stays stable.
  void advance(double dt_s) noexcept;
  // The formula of this output; 0 if the law has none.
  [[nodiscard]] double value(std::string_view output) const noexcept;
  [[nodiscard]] bool has(std::string_view output) const noexcept;

 private:
  struct State {
    double start;
    Formula rate;
    double* value;
    double rate_now;
    double slope_now;  // of the rate over the state
  };
  struct Output {
    std::string_view name;
    Formula formula;
  };
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<State> states_;
  std::vector<Output> outputs_;
};

StackedEffect make_formula_effect(const DeclaredEffect& effect, std::span<const double> values);

}  // namespace touchstone::renderers
