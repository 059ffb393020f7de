#include "harness/discrepancy/law_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace touchstone::discrepancy {

namespace {

// What the pieces follow, each once.
std::vector<std::string> carriers_of(const UnknownLaw& law) {
  std::vector<std::string> names;
  for (const LawPiece& piece : law.pieces) {
    for (const Carrier carrier : piece.carriers) {
      const std::string name = to_string(carrier);
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

nlohmann::json json_number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace

std::string law_follows(const UnknownLaw& law) { return fmt::format("{}", fmt::join(carriers_of(law), " and ")); }

std::vector<std::string> law_formulas(const UnknownLaw& law) {
  std::vector<std::string> lines;
  for (const LawPiece& piece : law.pieces) {
    for (const rendering::DeclaredState& state : piece.effect->states)
      lines.push_back(fmt::format("{}: d{}/dt = {}", piece.effect->name, state.name, state.rate));
    for (const rendering::DeclaredFormula& formula : piece.effect->formulas)
      lines.push_back(fmt::format("{}: {} = {}", piece.effect->name, formula.output, formula.text));
  }
  return lines;
}

nlohmann::ordered_json law_json(const UnknownLaw& law, const LawGap& gap) {
  nlohmann::ordered_json out{
      {"warning", "empirical: no physics, and valid only for motions like those that it was found in"},
      {"follows", carriers_of(law)},
      {"formulas", law_formulas(law)},
      {"pieces", nlohmann::ordered_json::array()},
      {"not_needed_beside_it", law.needless},
      {"holdout",
       {{"start", json_number(gap.start_N)},
        {"without", json_number(gap.without_N)},
        {"with", json_number(gap.with_N)},
        {"closed", json_number(gap.closed)},
        {"chi_squared_gain", json_number(gap.chi_squared_gain)},
        {"chi_squared_error", json_number(gap.chi_squared_error)}}},
      {"seen", nlohmann::ordered_json::object()}};
  std::size_t count = 0;
  for (const LawPiece& piece : law.pieces) {
    nlohmann::ordered_json values = nlohmann::ordered_json::object();
    for (const rendering::ParameterDeclaration& parameter : piece.effect->parameters)
      values[parameter.name] = {{"unit", parameter.unit}, {"value", json_number(parameter.initial)}};
    out["pieces"].push_back({{"file", fmt::format("law-{}.json", ++count)},
                             {"name", piece.effect->name},
                             {"summary", piece.effect->summary},
                             {"parameters", std::move(values)},
                             {"validation_chi_squared_gain", json_number(piece.validation_gain)},
                             {"bar", json_number(piece.null_threshold)}});
  }
  for (const SeenRange& range : law.seen)
    out["seen"][range.variable] = {
        {"unit", range.unit}, {"low", json_number(range.low)}, {"high", json_number(range.high)}};
  return out;
}

}  // namespace touchstone::discrepancy
