// A renderer's entry as a subject of the conformance suite: the suite runs it in worlds of other units of length, for
// which its parameters must change as their units say.
#pragma once

#include <cctype>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/testing/renderer_conformance.h"

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

// What the suite must know of a renderer besides its entry.
struct SubjectFacts {
  std::map<std::string, double> parameters;  // others have their defaults
  double stiffness_N_per_m = 0.0;            // the steepest rise of force with depth; 0: the value of stiffness_N_per_m
  double friction = 0.0;                     // largest |f_t| / f_n
  double tip_radius_m = 0.0;
};

// `name`: letters, digits and underscores; other characters of the entry's name become underscores. Throws BadData for
// parameters that the entry does not declare, UsageError when the stiffness is neither given nor declared.
inline RendererSubject subject_of(const RendererEntry& entry, const SubjectFacts& facts) {
  RendererSubject subject;
  for (const char c : entry.name) subject.name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  const Parameters checked(entry.parameters, facts.parameters, "renderer " + entry.name, "the suite", "");
  subject.make = [entry, given = facts.parameters](std::shared_ptr<const Surface> surface, double unit) {
    const Parameters parameters(entry.parameters, in_unit(entry.parameters, given, unit), "renderer " + entry.name,
                                "the suite", "");
    return entry.make(parameters, std::move(surface));
  };
  subject.stiffness_N_per_m = facts.stiffness_N_per_m;
  if (subject.stiffness_N_per_m == 0.0) {
    const auto declared = checked.values().find("stiffness_N_per_m");
    if (declared == checked.values().end()) {
      throw UsageError("the renderer " + entry.name +
                       " has no parameter stiffness_N_per_m: say how steeply its force rises with depth, in N/m");
    }
    subject.stiffness_N_per_m = declared->second;
  }
  subject.friction = facts.friction;
  subject.tip_radius_m = facts.tip_radius_m;
  subject.cannot = entry.cannot;
  return subject;
}

}  // namespace touchstone::testing
