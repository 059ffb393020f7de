#include "harness/renderer_faults/entry_engine.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::renderer_faults {

int length_power(const std::string& unit) {
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

std::map<std::string, double> in_unit(const std::vector<rendering::ParameterDeclaration>& declared,
                                      const std::map<std::string, double>& given, double unit) {
  std::map<std::string, double> values;
  for (const auto& declaration : declared) {
    const auto found = given.find(declaration.name);
    const double value = found == given.end() ? declaration.initial : found->second;
    values[declaration.name] = value * std::pow(unit, length_power(declaration.unit));
  }
  return values;
}

Engine engine_of(const rendering::RendererEntry& entry, const EngineFacts& facts) {
  Engine engine;
  for (const char c : entry.name) engine.name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  const rendering::Parameters checked(entry.parameters, facts.parameters, "renderer " + entry.name, "the options", "");
  engine.make = [entry, given = facts.parameters](std::shared_ptr<const surface::Surface> surface, double unit) {
    const rendering::Parameters parameters(entry.parameters, in_unit(entry.parameters, given, unit),
                                           "renderer " + entry.name, "the options", "");
    return entry.make(parameters, std::move(surface));
  };
  engine.stiffness_N_per_m = facts.stiffness_N_per_m;
  if (engine.stiffness_N_per_m == 0.0) {
    const auto stiffness = checked.values().find("stiffness_N_per_m");
    if (stiffness == checked.values().end()) {
      throw UsageError("the renderer " + entry.name +
                       " has no parameter stiffness_N_per_m: say how steeply its force rises with depth, in N/m");
    }
    engine.stiffness_N_per_m = stiffness->second;
  }
  const auto declared = [&](const char* name) {
    const auto found = checked.values().find(name);
    return found == checked.values().end() ? 0.0 : found->second;
  };
  engine.friction = facts.friction;
  if (engine.friction == 0.0) engine.friction = std::max(declared("mu_static"), declared("mu_dynamic"));
  engine.tip_radius_m = facts.tip_radius_m;
  if (engine.tip_radius_m == 0.0) engine.tip_radius_m = declared("tip_radius_m");
  engine.epsilon_m = facts.epsilon_m;
  if (engine.epsilon_m == 0.0) engine.epsilon_m = declared("epsilon_m");
  if (engine.epsilon_m == 0.0) engine.epsilon_m = entry.epsilon_m;
  engine.lag_samples = static_cast<int>(std::lround(declared("lag_samples")));
  engine.cannot = entry.cannot;
  return engine;
}

}  // namespace touchstone::renderer_faults
