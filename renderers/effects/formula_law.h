// The formulas of an effect that a user declared (harness/rendering/declared_effect.h), ready to be evaluated at every
// step, and the same as an effect of the contact.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "harness/base/vec.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/effect.h"
#include "harness/rendering/effect_stack.h"
#include "harness/rendering/formula.h"

namespace touchstone::renderers {

// Stays where it was made: its formulas look their variables up in it.
class FormulaLaw {
 public:
  explicit FormulaLaw(rendering::DeclaredEffect effect);
  FormulaLaw(const FormulaLaw&) = delete;
  FormulaLaw& operator=(const FormulaLaw&) = delete;

  // `values`: of the parameters, in their order, already checked. States at their start.
  void set(std::span<const double> values) noexcept;
  // Whether this is the law of `effect`: the same names, starts and formulas.
  [[nodiscard]] bool is_of(const rendering::DeclaredEffect& effect) const noexcept;

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
    rendering::Formula rate;
    double* value;
    double rate_now;
    double slope_now;  // of the rate over the state
  };
  struct Output {
    std::string_view name;
    rendering::Formula formula;
  };
  rendering::DeclaredEffect effect_;
  std::vector<std::string> names_;
  std::vector<double> values_;
  double* parameters_ = nullptr;
  std::vector<State> states_;
  std::vector<Output> outputs_;
};

// A law that is ready to run: one that this thread read before and nobody runs now, or read anew. To read its formulas
// takes longer than a run over a short recording, and a search runs a law thousands of times.
class ReadyLaw {
 public:
  ReadyLaw(const rendering::DeclaredEffect& effect, std::span<const double> values);
  ReadyLaw(const ReadyLaw&) = delete;
  ReadyLaw& operator=(const ReadyLaw&) = delete;
  ~ReadyLaw();

  FormulaLaw* operator->() const noexcept { return law_.get(); }

 private:
  struct Idle;
  std::weak_ptr<Idle> idle_;  // of the thread that made this; empty once that has ended
  std::unique_ptr<FormulaLaw> law_;
};

rendering::StackedEffect make_formula_effect(const rendering::DeclaredEffect& effect, std::span<const double> values);

}  // namespace touchstone::renderers
