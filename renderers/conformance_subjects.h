// Renderers of the catalogue, with effects or without, as subjects of the conformance suite.
#pragma once

#include <cmath>
#include <sstream>
#include <utility>

#include "harness/testing/renderer_conformance.h"
#include "renderers/catalogue.h"

namespace touchstone::testing {

// The power of length in a unit: "N/m" -1, "m" 1, "N s/m^2" -2, "1" 0.
inline int length_power(const std::string& unit) {
  int power = 0;
  int sign = 1;
  std::string word;
  const auto take = [&] {
    if (word == "m") power += sign;
    if (word.size() > 1 && word[0] == 'm' && (word[1] == '^' || std::isdigit(static_cast<unsigned char>(word[1])))) {
      power += sign * (word.back() - '0');
    }
    word.clear();
  };
  for (const char c : unit) {
    if (c == ' ' || c == '/' || c == '(' || c == ')')
      take();
    else
      word += c;
    if (c == '/') sign = -1;
  }
  take();
  return power;
}

// The parameters, defaults filled in, for a world whose lengths are multiplied by `unit`.
inline std::map<std::string, double> in_unit(const std::vector<ParameterDeclaration>& declared,
                                             const std::map<std::string, double>& given, double unit) {
  std::map<std::string, double> values;
  for (const auto& declaration : declared) {
    const auto found = given.find(declaration.name);
    const double value = found == given.end() ? declaration.initial : found->second;
    values[declaration.name] = value * std::pow(unit, length_power(declaration.unit));
  }
  return values;
}

inline Model in_unit(Model model, double unit) {
  model.parameters = in_unit(find_renderer(model).parameters, model.parameters, unit);
  for (auto& effect : model.effects) {
    for (const auto& declaration : effect_catalogue()) {
      if (declaration.name == effect.name) effect.parameters = in_unit(declaration.parameters, effect.parameters, unit);
    }
  }
  return model;
}

// `model` in JSON; what the renderer cannot do comes from the catalogue, with `besides` for what its effects cannot.
inline RendererSubject subject_of(std::string name, const std::string& json, double stiffness_N_per_m,
                                  double friction = 0.0, double tip_radius_m = 0.0,
                                  std::vector<Limitation> besides = {}) {
  const Model model = parse_model(json, name);
  RendererSubject subject;
  subject.name = std::move(name);
  subject.make = [model](std::shared_ptr<const Surface> surface, double unit) {
    return make_renderer(in_unit(model, unit), std::move(surface));
  };
  subject.stiffness_N_per_m = stiffness_N_per_m;
  subject.friction = friction;
  subject.tip_radius_m = tip_radius_m;
  subject.cannot = find_renderer(model).cannot;
  subject.cannot.insert(subject.cannot.end(), besides.begin(), besides.end());
  return subject;
}

}  // namespace touchstone::testing
