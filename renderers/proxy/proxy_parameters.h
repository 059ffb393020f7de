// The parameters that every renderer with a proxy (god-object) has, declared once.
#pragma once

#include <vector>

#include "harness/rendering/parameters.h"

namespace touchstone::renderers {

// stiffness_N_per_m and tip_radius_m, then `more`.
std::vector<rendering::ParameterDeclaration> proxy_parameters(std::vector<rendering::ParameterDeclaration> more = {});

}  // namespace touchstone::renderers
