#include "renderers/proxy/scene_renderer.h"

#include <fmt/format.h>

#include "harness/base/error.h"

namespace touchstone::renderers {

void check_scene_tip(const rendering::Parameters& parameters) {
  const double radius_m = parameters.at("tip_radius_m");
  if (!(radius_m > 0.0)) return;
  throw BadData(fmt::format(
      "tip_radius_m = {}: among bodies that move against each other the tip is a point (tip_radius_m 0); a ball can "
      "touch one body that moves, or several at rest",
      radius_m));
}

}  // namespace touchstone::renderers
