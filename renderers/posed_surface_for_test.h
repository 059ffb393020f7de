// What tests of renderers on analytic surfaces share: a surface of the catalogue at another scale and in an awkward
// pose.
#pragma once

#include <memory>
#include <string>

#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/posed_surface.h"

namespace touchstone::renderers {

// Every length of the surface's parameters times `scale`.
inline std::shared_ptr<const synthetic::AnalyticSurface> posed(const std::string& name, double scale) {
  synthetic::ParameterOverrides overrides;
  for (const auto& entry : synthetic::surface_catalogue()) {
    if (entry.name != name) continue;
    for (const auto& p : entry.parameters) {
      if (p.unit == "m") overrides[p.name] = p.initial * scale;
    }
  }
  return std::make_shared<synthetic::PosedSurface>(synthetic::make_surface(name, overrides), awkward_rotation(),
                                                   scale * Vec3(0.01, -0.02, 0.005));
}

}  // namespace touchstone::renderers
