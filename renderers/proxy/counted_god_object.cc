#include "renderers/proxy/counted_god_object.h"

namespace touchstone::renderers {

std::unique_ptr<rendering::Renderer> make_counted_god_object(std::shared_ptr<const surface::Surface> surface,
                                                             double stiffness_N_per_m, double tip_radius_m,
                                                             const ConeFriction& friction) {
  return make_counted_proxy(std::move(surface), stiffness_N_per_m, tip_radius_m, friction, NoShading{});
}

}  // namespace touchstone::renderers
