#include "renderers/counted_god_object.h"

namespace touchstone {

std::unique_ptr<Renderer> make_counted_god_object(std::shared_ptr<const Surface> surface, double stiffness_N_per_m,
                                                  const ConeFriction& friction) {
  return make_counted_proxy(std::move(surface), stiffness_N_per_m, friction, NoShading{});
}

}  // namespace touchstone
