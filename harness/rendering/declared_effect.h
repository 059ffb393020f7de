// An effect that a user declares in a file: formulas with parameters, units and bounds. Format "touchstone-effect/1"
// (JSON); docs/how-to/declare-an-effect.md has its keys. A model file names such a file, or holds its text, under "law"
// of an entry; the search for missing effects takes it as a hypothesis like those of the catalogue.
//
// Formulas are in SI. Each is held against its units when it is read (Buckingham 1914): in other units of length, time
// and force it must give the same quantity, so that no number in it hides a unit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

// What the formulas change, and when (EffectPhase, InstrumentStage).
enum class ActsOn : std::uint8_t {
  depth,         // depth_m is added to the penetration, near the surface too
  stiffness,     // factor multiplies the normal force
  normal_force,  // normal_N is added to the normal force, which stays at least 0
  friction,      // along_N along the tip's way over the surface, or x_N, y_N, z_N, of which the tangential part counts
  tool,          // x_N, y_N, z_N on the tool, touching or not, in the object's frame; an instrument entry
  sensor,        // the same in the sensor's frame, added to its reading; an instrument entry
};

// A number that remembers, of an effect of the contact: it is `start` at the first sample of every contact and then
// changes by its rate, a formula that may name all states.
struct DeclaredState {
  std::string name;
  std::string unit;
  double start = 0.0;
  std::string rate;  // in `unit` per second
};

struct DeclaredFormula {
  std::string output;  // a key of ActsOn: "along_N"
  std::string text;
};

struct DeclaredVariable {
  std::string_view name;
  std::string_view unit;
};

struct DeclaredEffect {
  std::string name;
  std::string summary;
  std::string source;  // where the law is published, or what it was found in
  ActsOn acts_on = ActsOn::normal_force;
  std::vector<ParameterDeclaration> parameters;  // sorted by name; `initial` is the first start
  std::vector<std::vector<double>> starts;       // of each parameter, where a search begins; at least one
  std::vector<DeclaredState> states;
  std::vector<DeclaredFormula> formulas;
  EffectTraits traits;
  bool empirical = false;  // no physics: found in data, and valid only for motions like theirs

  // Of the measurement and not of the contact: what model files say under "instrument".
  [[nodiscard]] bool is_instrument() const { return acts_on == ActsOn::tool || acts_on == ActsOn::sensor; }
};

// What the formulas of an effect may name beside its parameters, its states and pi. Positions and velocities are the
// tip's, in the object's frame; velocities are differences of neighbouring samples. `normal_N` and `f?_N` are what came
// before this effect.
const std::vector<DeclaredVariable>& variables_of(ActsOn acts_on);

// Strict. Throws BadData that names file, key, the position in the formula, and what was expected.
DeclaredEffect load_effect(const std::filesystem::path& path);
DeclaredEffect parse_effect(std::string_view text, std::string_view source);
// `place`: the JSON pointer of the value in `source`.
DeclaredEffect read_effect(const nlohmann::json& value, const std::string& source, const std::string& place);

// The file's text; parse_effect() gives the same effect back.
std::string effect_to_json(const DeclaredEffect& effect);
nlohmann::ordered_json effect_document(const DeclaredEffect& effect);

}  // namespace touchstone::rendering
