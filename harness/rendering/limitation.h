// What a renderer cannot do, declared by itself: the conformance suite skips such a test with the reason shown, and
// reports print it. Whatever is not declared here is demanded.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::rendering {

enum class Ability : std::uint8_t {
  thin_shells,       // a tip pushed through a thin shell from outside stays outside
  large_jumps,       // a tip that jumps through a body in one step stays on the side it came from
  start_inside,      // a run that starts inside is pushed out
  continuous_force,  // no jump of the force at first contact, on leaving, and across bends
  rigid_motion,      // moving and turning the whole world changes nothing
  unit_scale,        // nor does the unit of length
  passive,           // closed loops give no energy back beyond rounding
  surface_contact,   // the surface contact point lies on or above the surface
  ball_tip,          // renders a tip of finite radius
  analytic_surface,  // runs on surfaces that have no triangles
};

// As plug-ins declare them, in the order of the abilities.
constexpr std::array<std::string_view, 10> ability_names{
    "thin_shells", "large_jumps", "start_inside",    "continuous_force", "rigid_motion",
    "unit_scale",  "passive",     "surface_contact", "ball_tip",         "analytic_surface"};
constexpr std::string_view ability_name(Ability ability) { return ability_names[static_cast<std::size_t>(ability)]; }

struct Limitation {
  Ability ability;
  std::string reason;
};

inline const Limitation* find_limitation(const std::vector<Limitation>& limitations, Ability ability) {
  const auto found = std::find_if(limitations.begin(), limitations.end(),
                                  [ability](const Limitation& limitation) { return limitation.ability == ability; });
  return found == limitations.end() ? nullptr : &*found;
}

}  // namespace touchstone::rendering
