#include "renderers/spring/penalty.h"

#include <limits>

#include "renderers/spring/counted_feet.h"

namespace touchstone::renderers {
using rendering::Ability;

namespace {

template <class Feet>
std::unique_ptr<rendering::Renderer> make(const rendering::Parameters& parameters,
                                          std::shared_ptr<const surface::Surface> surface) {
  return make_closest_spring<1, Feet>(std::move(surface), parameters.at("stiffness_N_per_m"),
                                      parameters.at("tip_radius_m"));
}

}  // namespace

rendering::RendererEntry penalty_entry() {
  return {
      "penalty",
      "pushes the tip to the closest surface point with a spring, without memory",
      "Ruffaldi et al. 2006, equation 1; Zilles and Salisbury 1995, section 2",
      {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "of the spring out of the body"},
       {"tip_radius_m", "m", 0.0, 1e3, 0.0, "0: a point; else a ball whose centre the positions are"}},
      {{Ability::thin_shells, "it remembers no side: past the middle of a thin shell it pushes out on the far side"},
       {Ability::large_jumps, "it remembers no side: a tip that jumps through a body is free on the far side"},
       {Ability::continuous_force, "the closest surface point jumps where two are equally close"},
       {Ability::surface_contact, "a ball in a concave corner is pushed off the nearest wall only"}},
      make<SurfaceFeet>,
      make<CountedFeet>};
}

}  // namespace touchstone::renderers
