#include "harness/rendering/declared_effect.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/base/json_reader.h"
#include "harness/base/known_names.h"
#include "harness/base/random.h"
#include "harness/rendering/formula.h"
#include "harness/rendering/unit_dimension.h"

namespace touchstone::rendering {
namespace {

constexpr const char* effect_schema = "touchstone-effect/1";

struct Kind {
  std::string_view name;
  ActsOn acts_on;
  std::vector<DeclaredVariable> outputs;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"depth", ActsOn::depth, {{"depth_m", "m"}}},
      {"stiffness", ActsOn::stiffness, {{"factor", "1"}}},
      {"normal-force", ActsOn::normal_force, {{"normal_N", "N"}}},
      {"friction", ActsOn::friction, {{"along_N", "N"}, {"x_N", "N"}, {"y_N", "N"}, {"z_N", "N"}}},
      {"tool", ActsOn::tool, {{"x_N", "N"}, {"y_N", "N"}, {"z_N", "N"}}},
      {"sensor", ActsOn::sensor, {{"x_N", "N"}, {"y_N", "N"}, {"z_N", "N"}}},
  };
  return all;
}

const Kind& kind_of(ActsOn acts_on) {
  return *std::find_if(kinds().begin(), kinds().end(), [&](const Kind& kind) { return kind.acts_on == acts_on; });
}

// Everything that the formulas of one effect may name, with a value to evaluate them at.
struct Names {
  std::vector<std::string> names;
  std::vector<UnitDimension> dimensions;
  std::vector<double> values;

  void add(std::string name, const UnitDimension& dimension) {
    names.push_back(std::move(name));
    dimensions.push_back(dimension);
    values.push_back(0.0);
  }
  [[nodiscard]] bool has(const std::string& name) const {
    return std::find(names.begin(), names.end(), name) != names.end();
  }
  [[nodiscard]] std::vector<FormulaVariable> variables() {
    std::vector<FormulaVariable> all;
    for (std::size_t i = 0; i < names.size(); ++i) all.push_back({names[i], &values[i]});
    return all;
  }
};

UnitDimension read_dimension(JsonObject& owner, const char* key, const std::string& unit) {
  const auto dimension = dimension_of(unit);
  if (!dimension) {
    owner.fail_at(key, fmt::format("\"{}\" is no unit that is known; products and powers of {} are, as in \"N s/m\"; "
                                   "formulas calculate in SI, so that there are no millimetres",
                                   unit, known_base_units()));
  }
  return *dimension;
}

bool is_identifier(std::string_view name) {
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  return !name.empty() && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || c == '_' || (c >= '0' && c <= '9'); });
}

bool is_effect_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
}

// A factor that no formula has by chance, for each of the base units.
constexpr std::array<double, UnitDimension::count> other_units{1.37, 0.83, 1.91};

double in_other_units(double value, const UnitDimension& dimension, std::size_t base) {
  return value * std::pow(other_units.at(base), dimension.powers.at(base));
}

// How a formula stands in other units.
struct UnitCheck {
  std::optional<std::size_t> wrong_base;  // in which it is not the quantity that it is declared as; nothing: in none
  int places = 0;                         // at which it was a number in the units of the file, and so was looked at
};

UnitCheck check_units(const Formula& formula, Names& names, const UnitDimension& result) {
  constexpr int places = 12, most_tries = 1000;
  constexpr double rounding = 1e-9;
  Random random(0xd1e5);
  const std::size_t n = names.values.size();
  std::vector<double> at(n);
  UnitCheck check;
  for (int tries = 0; tries < most_tries && check.places < places; ++tries) {
    for (double& value : at) value = (random.uniform() < 0.3 ? -1.0 : 1.0) * (0.2 + 1.6 * random.uniform());
    std::copy(at.begin(), at.end(), names.values.begin());
    const double here = formula.value();
    if (!std::isfinite(here)) continue;
    ++check.places;
    for (std::size_t base = 0; base < UnitDimension::count; ++base) {
      for (std::size_t i = 0; i < n; ++i) names.values[i] = in_other_units(at[i], names.dimensions[i], base);
      const double there = formula.value();
      const double expected = in_other_units(here, result, base);
      if (std::isfinite(there) && std::abs(there - expected) > rounding * (std::abs(there) + std::abs(expected)))
        return {base, check.places};
    }
  }
  return check;
}

// Compiles the formula and holds it against its unit. The names that it uses.
std::vector<std::string> check_formula(const std::string& text, Names& names, const UnitDimension& result,
                                       std::string_view unit, const std::string& place) {
  const Formula formula(text, names.variables(), place);
  const UnitCheck check = check_units(formula, names, result);
  if (check.places == 0) {
    throw BadData(fmt::format(
        "{}: \"{}\" is a number nowhere (the root of a negative one?); its unit cannot be checked", place, text));
  }
  if (const auto base = check.wrong_base) {
    constexpr std::array<std::string_view, UnitDimension::count> of{"length", "time", "force"};
    throw BadData(
        fmt::format("{}: \"{}\" is not a quantity in {}: in another unit of {} it gives something else; "
                    "every term needs that unit, arguments of functions such as exp and sin need none, and a "
                    "number with a unit is to be a parameter",
                    place, text, unit, of.at(*base)));
  }
  return formula.used();
}

void read_starts(JsonObject& object, const ParameterDeclaration& declaration, std::vector<double>& starts) {
  starts = object.raw("start").is_array() ? object.numbers("start") : std::vector{object.number("start")};
  if (starts.empty()) object.fail_at("start", "at least one value to start from was expected");
  for (const double start : starts) {
    if (!(start >= declaration.minimum && start <= declaration.maximum)) {
      object.fail_at("start", fmt::format("{} is out of range; {} to {} {} was declared", start, declaration.minimum,
                                          declaration.maximum, declaration.unit));
    }
  }
}

void refuse_name(JsonObject& owner, const std::string& name, const Names& names) {
  if (!is_identifier(name))
    owner.fail_at(name, "a name was expected that formulas can use: letters, digits and _, first a letter");
  if (names.has(name) || name == "pi")
    owner.fail_at(name, "formulas have a variable of this name already; choose another one");
}

void read_parameters(JsonObject& root, DeclaredEffect& effect, Names& names) {
  if (!root.has("parameters")) return;
  JsonObject list = root.object("parameters");
  for (const std::string& name : list.keys()) {
    refuse_name(list, name, names);
    JsonObject object = list.object(name);
    ParameterDeclaration declaration;
    declaration.name = name;
    declaration.unit = object.text("unit");
    declaration.minimum = object.number("minimum");
    declaration.maximum = object.number("maximum");
    declaration.meaning = object.optional_text("meaning").value_or("declared in " + root.source());
    if (!(declaration.minimum < declaration.maximum)) {
      object.fail_at("maximum",
                     fmt::format("{} is not above the minimum {}", declaration.maximum, declaration.minimum));
    }
    std::vector<double> starts;
    read_starts(object, declaration, starts);
    names.add(name, read_dimension(object, "unit", declaration.unit));
    object.finish();
    declaration.initial = starts.front();
    effect.parameters.push_back(std::move(declaration));
    effect.starts.push_back(std::move(starts));
  }
}

// Their rates are checked by read_formulas(), when all states are known.
void read_states(JsonObject& root, DeclaredEffect& effect, Names& names) {
  if (!root.has("states")) return;
  // Long recordings are compared piece by piece, and a piece of a measurement has no past.
  if (effect.is_instrument()) root.fail_at("states", "only effects of the contact have states");
  JsonObject list = root.object("states");
  for (const std::string& name : list.keys()) {
    refuse_name(list, name, names);
    JsonObject object = list.object(name);
    DeclaredState state{name, object.text("unit"), object.optional_number("start").value_or(0.0), object.text("rate")};
    names.add(name, read_dimension(object, "unit", state.unit));
    object.finish();
    effect.states.push_back(std::move(state));
  }
}

void set_traits(DeclaredEffect& effect, const std::vector<std::string>& used) {
  const auto uses = [&](std::initializer_list<std::string_view> any) {
    return std::any_of(used.begin(), used.end(),
                       [&](const std::string& name) { return std::find(any.begin(), any.end(), name) != any.end(); });
  };
  effect.traits.follows_speed = uses({"speed_m_per_s", "depth_rate_m_per_s", "vx_m_per_s", "vy_m_per_s", "vz_m_per_s"});
  effect.traits.along_surface = !effect.is_instrument() && uses({"x_m", "y_m", "z_m"});
}

void read_formulas(JsonObject& root, DeclaredEffect& effect, Names& names) {
  const Kind& kind = kind_of(effect.acts_on);
  std::vector<std::string> known;
  for (const DeclaredVariable& output : kind.outputs) known.emplace_back(output.name);
  std::vector<std::string> used;
  const auto note = [&](const std::vector<std::string>& more) { used.insert(used.end(), more.begin(), more.end()); };
  for (const DeclaredState& state : effect.states) {
    UnitDimension rate = *dimension_of(state.unit);
    --rate.powers[UnitDimension::second];
    note(check_formula(state.rate, names, rate, fmt::format("{} per second", state.unit),
                       fmt::format("{}: {}/states/{}/rate", root.source(), root.place(), state.name)));
  }
  JsonObject list = root.object("formula");
  root.finish();  // a key that nothing reads may be what a formula misses
  for (const std::string& key : list.keys()) {
    const auto output = std::find_if(kind.outputs.begin(), kind.outputs.end(),
                                     [&](const DeclaredVariable& one) { return one.name == key; });
    if (output == kind.outputs.end()) {
      list.fail_at(key,
                   unknown_name(fmt::format("formula of an effect that acts on {} called", kind.name), key, known));
    }
    DeclaredFormula formula{key, list.text(key)};
    note(check_formula(formula.text, names, *dimension_of(output->unit), output->unit,
                       fmt::format("{}: {}/{}", list.source(), list.place(), key)));
    effect.formulas.push_back(std::move(formula));
  }
  list.finish();
  if (effect.formulas.empty())
    root.fail_at("formula", fmt::format("no formula; one for {} was expected", fmt::join(known, ", ")));
  for (const ParameterDeclaration& parameter : effect.parameters) {
    if (std::find(used.begin(), used.end(), parameter.name) == used.end())
      root.fail_at("parameters/" + parameter.name, "no formula uses this parameter; use it or leave it out");
  }
  set_traits(effect, used);
}

ActsOn read_acts_on(JsonObject& root) {
  const std::string name = root.text("acts_on");
  std::vector<std::string_view> known;
  for (const Kind& kind : kinds()) {
    if (kind.name == name) return kind.acts_on;
    known.push_back(kind.name);
  }
  root.fail_at("acts_on", fmt::format("one of {} was expected, got \"{}\"", fmt::join(known, ", "), name));
}

void read_contains(JsonObject& root, DeclaredEffect& effect) {
  if (!root.has("contains")) return;
  const nlohmann::json& list = root.raw("contains");
  const bool texts =
      list.is_array() && std::all_of(list.begin(), list.end(), [](const auto& one) { return one.is_string(); });
  if (!texts) root.fail_at("contains", "a list of names of effects was expected");
  for (const auto& name : list) effect.traits.contains.push_back(name.get<std::string>());
}

}  // namespace

const std::vector<DeclaredVariable>& variables_of(ActsOn acts_on) {
  static const std::vector<DeclaredVariable> contact{{"t_s", "s"},
                                                     {"x_m", "m"},
                                                     {"y_m", "m"},
                                                     {"z_m", "m"},
                                                     {"vx_m_per_s", "m/s"},
                                                     {"vy_m_per_s", "m/s"},
                                                     {"vz_m_per_s", "m/s"},
                                                     {"nx", "1"},
                                                     {"ny", "1"},
                                                     {"nz", "1"},
                                                     {"depth_m", "m"},
                                                     {"depth_rate_m_per_s", "m/s"},
                                                     {"normal_N", "N"},
                                                     {"speed_m_per_s", "m/s"},
                                                     {"stiffness_N_per_m", "N/m"}};
  static const std::vector<DeclaredVariable> instrument{
      {"t_s", "s"},          {"x_m", "m"},          {"y_m", "m"},  {"z_m", "m"},  {"vx_m_per_s", "m/s"},
      {"vy_m_per_s", "m/s"}, {"vz_m_per_s", "m/s"}, {"fx_N", "N"}, {"fy_N", "N"}, {"fz_N", "N"}};
  return acts_on == ActsOn::tool || acts_on == ActsOn::sensor ? instrument : contact;
}

DeclaredEffect read_effect(const nlohmann::json& value, const std::string& source, const std::string& place) {
  JsonObject root(value, source, place);
  root.schema(effect_schema);
  DeclaredEffect effect;
  effect.name = root.text("name");
  if (!is_effect_name(effect.name))
    root.fail_at("name", fmt::format("small letters, digits and - were expected, got \"{}\"", effect.name));
  effect.summary = root.text("summary");
  effect.source = root.text("source");
  effect.acts_on = read_acts_on(root);
  effect.empirical = root.optional_flag("empirical").value_or(false);
  read_contains(root, effect);
  Names names;
  for (const DeclaredVariable& variable : variables_of(effect.acts_on))
    names.add(std::string(variable.name), *dimension_of(variable.unit));
  read_parameters(root, effect, names);
  read_states(root, effect, names);
  read_formulas(root, effect, names);
  return effect;
}

DeclaredEffect parse_effect(std::string_view text, std::string_view source) {
  return read_effect(parse_json(text, source), std::string(source), "");
}

DeclaredEffect load_effect(const std::filesystem::path& path) {
  note_input_file(path);
  return parse_effect(read_file(path), path.string());
}

nlohmann::ordered_json effect_document(const DeclaredEffect& effect) {
  nlohmann::ordered_json document{{"schema", effect_schema},
                                  {"name", effect.name},
                                  {"summary", effect.summary},
                                  {"source", effect.source},
                                  {"acts_on", kind_of(effect.acts_on).name}};
  if (effect.empirical) document["empirical"] = true;
  if (!effect.traits.contains.empty()) document["contains"] = effect.traits.contains;
  auto parameters = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const ParameterDeclaration& p = effect.parameters[i];
    parameters[p.name] = {{"unit", p.unit}, {"minimum", p.minimum}, {"maximum", p.maximum}};
    if (effect.starts[i].size() == 1) {
      parameters[p.name]["start"] = effect.starts[i].front();
    } else {
      parameters[p.name]["start"] = effect.starts[i];
    }
    parameters[p.name]["meaning"] = p.meaning;
  }
  document["parameters"] = std::move(parameters);
  for (const DeclaredState& state : effect.states)
    document["states"][state.name] = {{"unit", state.unit}, {"start", state.start}, {"rate", state.rate}};
  for (const DeclaredFormula& formula : effect.formulas) document["formula"][formula.output] = formula.text;
  return document;
}

std::string effect_to_json(const DeclaredEffect& effect) { return effect_document(effect).dump(2) + "\n"; }

}  // namespace touchstone::rendering
