#include "renderers/spring.h"

#include <limits>

#include "renderers/closest_spring.h"

namespace touchstone {
namespace {

std::vector<Limitation> limitations() {
  return {{Ability::thin_shells, "it remembers no side: past the middle of a thin body it pushes on"},
          {Ability::large_jumps, "it remembers no side: a tip that jumps through is on the other side"},
          {Ability::continuous_force, "the closest surface point jumps where two are equally close"},
          {Ability::ball_tip, "it renders a point"}};
}

}  // namespace

RendererEntry spring_linear_entry() {
  return {"spring-linear",
          "F = k dx from the closest surface point, without memory",
          "Shao, Wu and Ouyang, section 3; the vector-field method of Zilles and Salisbury 1995",
          {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "k of F = k dx"}},
          limitations(),
          [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
            return std::make_unique<ClosestSpring<1, SurfaceFeet>>(SurfaceFeet(std::move(surface)),
                                                                   parameters.at("stiffness_N_per_m"), 0.0);
          }};
}

RendererEntry spring_quadratic_entry() {
  return {"spring-quadratic",
          "F = k dx^2 from the closest surface point, without memory: an unnatural spring for contrast",
          "Shao, Wu and Ouyang, section 3",
          {{"coefficient_N_per_m2", "N/m^2", std::numeric_limits<double>::min(), 1e12, 5e4, "k of F = k dx^2"}},
          limitations(),
          [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
            return std::make_unique<ClosestSpring<2, SurfaceFeet>>(SurfaceFeet(std::move(surface)),
                                                                   parameters.at("coefficient_N_per_m2"), 0.0);
          }};
}

}  // namespace touchstone
