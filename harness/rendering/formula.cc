#include "harness/rendering/formula.h"

#include <fmt/format.h>
#include <muParserDLL.h>

#include <algorithm>
#include <cctype>
#include <mutex>
#include <numbers>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/base/loaded_library.h"

namespace touchstone::rendering {
namespace {

// muParser's functions. Loaded by the first formula: linked, every start of the program would load it and OpenMP.
struct MuParser {
  decltype(&mupCreate) create = nullptr;
  decltype(&mupRelease) release = nullptr;
  decltype(&mupSetExpr) set_expression = nullptr;
  decltype(&mupDefineVar) define_variable = nullptr;
  decltype(&mupDefineConst) define_constant = nullptr;
  decltype(&mupEval) evaluate = nullptr;
  decltype(&mupEvalMulti) evaluate_list = nullptr;
  decltype(&mupGetExprVarNum) count_used = nullptr;
  decltype(&mupGetExprVar) get_used = nullptr;
  decltype(&mupSetErrorHandler) set_error_handler = nullptr;
  decltype(&mupError) failed = nullptr;
  decltype(&mupGetErrorPos) error_position = nullptr;
  decltype(&mupGetErrorToken) error_token = nullptr;
  decltype(&mupGetErrorMsg) error_message = nullptr;

  MuParser() {
    const LoadedLibrary library("libmuparser.so.2", "evaluates the formulas of effects", "libmuparser2v5");
    library.find(create, "mupCreate");
    library.find(release, "mupRelease");
    library.find(set_expression, "mupSetExpr");
    library.find(define_variable, "mupDefineVar");
    library.find(define_constant, "mupDefineConst");
    library.find(evaluate, "mupEval");
    library.find(evaluate_list, "mupEvalMulti");
    library.find(count_used, "mupGetExprVarNum");
    library.find(get_used, "mupGetExprVar");
    library.find(set_error_handler, "mupSetErrorHandler");
    library.find(failed, "mupError");
    library.find(error_position, "mupGetErrorPos");
    library.find(error_token, "mupGetErrorToken");
    library.find(error_message, "mupGetErrorMsg");
  }
};

const MuParser& mu_parser() {
  static const MuParser functions;
  return functions;
}

// muParser returns names and messages in static buffers.
std::mutex& texts_mutex() {
  static std::mutex mutex;
  return mutex;
}

void ignore_error(muParserHandle_t) {}

// Where a single '=' stands, which muParser takes for an assignment to a variable; npos: nowhere.
std::size_t assignment_in(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool second = i > 0 && std::string_view("=!<>").find(text[i - 1]) != std::string_view::npos;
    const bool first = i + 1 < text.size() && text[i + 1] == '=';
    if (!first && !second) return i;
  }
  return std::string_view::npos;
}

// muParser's words without its own position, which counts from 0; for a name that is not known the names that are.
std::string error_in(const std::vector<FormulaVariable>& variables, const std::string& token, std::string words) {
  std::vector<std::string> known;
  for (const FormulaVariable& variable : variables) known.push_back(variable.name);
  const bool is_name = !token.empty() && std::isalpha(static_cast<unsigned char>(token.front())) != 0;
  if (is_name && std::find(known.begin(), known.end(), token) == known.end())
    return unknown_name("variable or function", token, known);
  return words.substr(0, std::min(words.find(" found at position"), words.find(" at position")));
}

}  // namespace

Formula::Formula(std::string text, const std::vector<FormulaVariable>& variables, std::string_view place) {
  const auto refuse = [&](std::size_t position, const std::string& why) {
    throw BadData(fmt::format("{}: \"{}\": position {}: {}", place, text, position, why));
  };
  if (text.find_first_not_of(" \t") == std::string::npos)
    throw BadData(fmt::format("{}: the formula is empty; write 0 for no effect", place));
  if (const std::size_t at = assignment_in(text); at != std::string::npos)
    refuse(at + 1, "a formula assigns nothing; == compares");
  const MuParser& mu = mu_parser();
  parser_ = mu.create(muBASETYPE_FLOAT);
  try {
    mu.set_error_handler(parser_, &ignore_error);
    mu.define_constant(parser_, "pi", std::numbers::pi);
    for (const FormulaVariable& variable : variables)
      mu.define_variable(parser_, variable.name.c_str(), variable.value);
    mu.set_expression(parser_, text.c_str());
    int count = 0;
    mu.evaluate_list(parser_, &count);  // compiles
    const std::lock_guard lock(texts_mutex());
    if (mu.failed(parser_) != 0) {
      const std::string token = mu.error_token(parser_);
      const auto found = static_cast<std::size_t>(std::max(mu.error_position(parser_), 0)) + 1;
      const std::size_t position = std::min(found, text.size() + 1);  // just behind it where its end came too early
      refuse(position, error_in(variables, token, mu.error_message(parser_)));
    }
    if (count != 1) refuse(1, fmt::format("one value was expected, got {} between commas", count));
    for (int i = 0; i < mu.count_used(parser_); ++i) {
      const char* name = nullptr;
      double* value = nullptr;
      mu.get_used(parser_, static_cast<unsigned>(i), &name, &value);
      used_.emplace_back(name);
    }
    // Compiles once more, since the question above undid it: from here on an evaluation allocates nothing.
    mu.evaluate(parser_);
  } catch (...) {
    mu.release(parser_);
    throw;
  }
  std::sort(used_.begin(), used_.end());
}

Formula::Formula(Formula&& other) noexcept
    : parser_(std::exchange(other.parser_, nullptr)), used_(std::move(other.used_)) {}

Formula& Formula::operator=(Formula&& other) noexcept {
  std::swap(parser_, other.parser_);
  std::swap(used_, other.used_);
  return *this;
}

Formula::~Formula() {
  if (parser_ != nullptr) mu_parser().release(parser_);
}

double Formula::value() const noexcept { return mu_parser().evaluate(parser_); }

}  // namespace touchstone::rendering
