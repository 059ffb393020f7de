// How the coefficient of a force that goes with a rate enters a search.
#pragma once

#include <algorithm>
#include <string>

#include "harness/rendering/effect_traits.h"

namespace touchstone::renderers {

// From a twentieth of what would make the typical force at the typical rate, up to twenty times that.
inline rendering::SearchPlan plan_of_rate(const std::string& coefficient, double force_N, double typical_rate) {
  const double scale = force_N / std::max(typical_rate, 1e-12);
  return {{{coefficient, scale, 0.0, 20.0 * scale}}, {{{coefficient, 0.05 * scale}}}};
}

}  // namespace touchstone::renderers
