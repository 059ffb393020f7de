// A renderer's entry as an engine: the detectors run it in other units of length, for which its parameters
// must change as their units say.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/renderer_faults/engine.h"
#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderer_faults {

// The power of length in a unit: "N/m" -1, "m" 1, "N s/m^2" -2, "1" 0.
int length_power(const std::string& unit);

// The parameters, defaults filled in, for a world whose lengths are multiplied by `unit`.
std::map<std::string, double> in_unit(const std::vector<rendering::ParameterDeclaration>& declared,
                                      const std::map<std::string, double>& given, double unit);

// What must be known of a renderer besides its entry.
struct EngineFacts {
  std::map<std::string, double> parameters;  // others have their defaults
  double stiffness_N_per_m = 0.0;            // the steepest rise of force with depth; 0: the value of stiffness_N_per_m
  double friction = 0.0;      // largest |f_t| / f_n; 0: the larger value of mu_static and mu_dynamic, if it has them
  double tip_radius_m = 0.0;  // 0: the value of tip_radius_m, if it has that
  double epsilon_m = 0.0;     // lengths below it are nothing to the renderer; 0: the value of epsilon_m, if it has that
};

// Characters of the entry's name that are no letters, digits or underscores become underscores. Throws BadData for
// parameters that the entry does not declare, UsageError where the stiffness is neither given nor declared.
Engine engine_of(const rendering::RendererEntry& entry, const EngineFacts& facts);

}  // namespace touchstone::renderer_faults
