#include "renderers/effects/assemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/smooth_field.h"
#include "renderers/effects/catalogue.h"
#include "renderers/effects/formula_law.h"
#include "renderers/effects/friction.h"
#include "renderers/effects/height_image.h"

namespace touchstone::renderers {
using rendering::Model;
using rendering::NamedParameters;
using rendering::ParameterDeclaration;
using rendering::StackedEffect;

namespace {

const EffectEntry& entry_of(const NamedParameters& effect, const Model& model) {
  if (const EffectEntry* const entry = find_contact_effect(effect.name)) return *entry;
  std::vector<std::string> known;
  for (const EffectEntry& entry : contact_effects()) known.emplace_back(entry.name);
  throw BadData(
      fmt::format("{}: {}/name: {}", model.source, effect.place, unknown_name("contact effect", effect.name, known)));
}

StackedEffect make_declared(const NamedParameters& effect, const Model& model) {
  if (find_contact_effect(effect.name) != nullptr) {
    throw BadData(fmt::format("{}: {}/law: there is a contact effect {} of this name; give the law a name of its own",
                              model.source, effect.place, effect.name));
  }
  if (!effect.image.empty())
    throw BadData(fmt::format("{}: {}: a declared effect takes no \"image\"", model.source, effect.place));
  return make_formula_effect(*effect.law,
                             checked_values(effect, effect.law->parameters, "contact effect", model.source));
}

// A model without a break-away coefficient of its own breaks away where it slides.
void complete_coefficients(const NamedParameters& effect, const EffectEntry& entry, std::vector<double>& values) {
  if (effect.parameters.contains("mu_static")) return;
  const auto place = [&](std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(entry.parameters, name, &ParameterDeclaration::name) -
                                    entry.parameters.begin());
  };
  const std::size_t at_rest = place("mu_static");
  const std::size_t sliding = place("mu_dynamic");
  if (at_rest < values.size() && sliding < values.size()) values[at_rest] = std::max(values[at_rest], values[sliding]);
}

// Of the effects that have both coefficients.
void check_coefficients(const NamedParameters& effect, const EffectEntry& entry, std::span<const double> values,
                        const Model& model) {
  double mu_static = 0.0;
  double mu_dynamic = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (entry.parameters[i].name == "mu_static") mu_static = values[i];
    if (entry.parameters[i].name == "mu_dynamic") mu_dynamic = values[i];
  }
  touchstone::renderers::check_coefficients(mu_static, mu_dynamic,
                                            fmt::format("{}: {}/parameters", model.source, effect.place));
}

}  // namespace

std::vector<double> checked_values(const NamedParameters& entry, const std::vector<ParameterDeclaration>& declared,
                                   std::string_view what, std::string_view source) {
  const rendering::Parameters parameters(declared, entry.parameters, fmt::format("{} {}", what, entry.name), source,
                                         entry.place);
  if (is_field(declared))
    rendering::check_field(entry.parameters, fmt::format("{}: {}/parameters", source, entry.place));
  std::vector<double> values;
  values.reserve(declared.size());
  for (const ParameterDeclaration& declaration : declared) values.push_back(parameters.at(declaration.name));
  return values;
}

std::vector<StackedEffect> make_effects(const Model& model) {
  std::vector<StackedEffect> effects;
  for (const NamedParameters& effect : model.effects) {
    if (effect.law != nullptr) {
      effects.push_back(make_declared(effect, model));
      continue;
    }
    const EffectEntry& entry = entry_of(effect, model);
    auto values = checked_values(effect, entry.parameters, "contact effect", model.source);
    complete_coefficients(effect, entry, values);
    check_coefficients(effect, entry, values, model);
    if (entry.takes_image != !effect.image.empty()) {
      throw BadData(fmt::format("{}: {}: {}", model.source, effect.place,
                                entry.takes_image ? "\"image\" is missing: the name of a greyscale picture (PGM)"
                                                  : fmt::format("{} takes no \"image\"", entry.name)));
    }
    if (entry.takes_image) {
      effects.push_back({make_height_image(values, load_height_image(effect.image)), entry.phase, entry.needs_gap});
    }
    if (entry.make != nullptr) effects.push_back({entry.make(values), entry.phase, entry.needs_gap});
  }
  return effects;
}

std::map<std::string, double> base_parameters(const Model& model, const std::vector<ParameterDeclaration>& declared) {
  std::map<std::string, double> parameters = model.parameters;
  // As for effects: a break-away coefficient that is not given is the sliding one.
  const bool has_break_away =
      std::any_of(declared.begin(), declared.end(), [](const auto& d) { return d.name == "mu_static"; });
  if (const auto sliding = parameters.find("mu_dynamic"); has_break_away && sliding != parameters.end())
    parameters.try_emplace("mu_static", sliding->second);
  for (const NamedParameters& effect : model.effects) {
    if (effect.law != nullptr) continue;
    const EffectEntry& entry = entry_of(effect, model);
    if (entry.base_parameter.empty()) continue;
    const auto values = checked_values(effect, entry.parameters, "contact effect", model.source);
    const std::string name(entry.base_parameter);
    const auto declaration =
        std::find_if(declared.begin(), declared.end(), [&](const auto& parameter) { return parameter.name == name; });
    if (declaration == declared.end()) {
      throw BadData(fmt::format("{}: {}: the renderer {} cannot run the effect {}: it has no parameter {}",
                                model.source, effect.place, model.renderer, effect.name, name));
    }
    const auto given = parameters.find(name);
    parameters[name] = (given == parameters.end() ? declaration->initial : given->second) + values[0];
  }
  return parameters;
}

}  // namespace touchstone::renderers
