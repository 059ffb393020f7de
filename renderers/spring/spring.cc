#include "renderers/spring/spring.h"

#include <limits>

#include "renderers/spring/counted_feet.h"

namespace touchstone::renderers {
using rendering::Ability;

namespace {

template <int power, class Feet>
std::unique_ptr<rendering::Renderer> make(const rendering::Parameters& parameters,
                                          std::shared_ptr<const surface::Surface> surface) {
  const char* const k = power == 1 ? "stiffness_N_per_m" : "coefficient_N_per_m2";
  return make_closest_spring<power, Feet>(std::move(surface), parameters.at(k), 0.0);
}

std::vector<rendering::Limitation> limitations() {
  return {{Ability::thin_shells, "it remembers no side: past the middle of a thin body it pushes on"},
          {Ability::large_jumps, "it remembers no side: a tip that jumps through is on the other side"},
          {Ability::continuous_force, "the closest surface point jumps where two are equally close"},
          {Ability::ball_tip, "it renders a point"}};
}

}  // namespace

rendering::RendererEntry spring_linear_entry() {
  return {"spring-linear",
          "F = k dx from the closest surface point, without memory",
          "Shao, Wu and Ouyang, section 3; the vector-field method of Zilles and Salisbury 1995",
          {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "k of F = k dx"}},
          limitations(),
          make<1, SurfaceFeet>,
          make<1, CountedFeet>,
          /*has_exact_answer=*/true};
}

rendering::RendererEntry spring_quadratic_entry() {
  return {"spring-quadratic",
          "F = k dx^2 from the closest surface point, without memory: an unnatural spring for contrast",
          "Shao, Wu and Ouyang, section 3",
          {{"coefficient_N_per_m2", "N/m^2", std::numeric_limits<double>::min(), 1e12, 5e4, "k of F = k dx^2"}},
          limitations(),
          make<2, SurfaceFeet>,
          make<2, CountedFeet>};
}

}  // namespace touchstone::renderers
