// A formula that a user wrote, evaluated at every step: "-c * speed_m_per_s^2". The grammar is muParser's
// (muparser.beltoforion.de, version 2.3): + - * / ^, comparisons, && ||, a ? b : c, and functions such as sin, exp,
// sqrt, abs, sign, min, max; `pi` is known. Numbers have a point whatever the locale. Assignments and lists of values
// are refused.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::rendering {

// A name in a formula and where its value stands, which must outlive the formula.
struct FormulaVariable {
  std::string name;
  double* value;
};

class Formula {
 public:
  // `place`: "file: /formula/along_N", for messages. Throws BadData that names the place, the position in the formula
  // (1 is the first character), what stands there and, for a misspelt name, what was probably meant.
  Formula(std::string text, const std::vector<FormulaVariable>& variables, std::string_view place);
  Formula(const Formula&) = delete;
  Formula& operator=(const Formula&) = delete;
  Formula(Formula&& other) noexcept;
  Formula& operator=(Formula&& other) noexcept;
  ~Formula();

  // At the variables' values of now. Allocates nothing, takes no lock, does not throw; what is undefined (the root of a
  // negative number) is not a number. Of one formula by one thread at a time.
  [[nodiscard]] double value() const noexcept;

  // The variables that the formula names, each once, sorted.
  [[nodiscard]] const std::vector<std::string>& used() const noexcept { return used_; }

 private:
  void* parser_ = nullptr;  // muParser's handle
  std::vector<std::string> used_;
};

}  // namespace touchstone::rendering
