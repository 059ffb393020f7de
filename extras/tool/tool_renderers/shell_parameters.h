// Parameters that renderers share which stand a tool for the points of its surface (a point shell, tool.h).
#pragma once

#include "harness/rendering/renderer.h"

namespace touchstone::tool_renderers {

inline rendering::ParameterDeclaration contact_stiffness_parameter() {
  return {"contact_stiffness_N_per_m", "N/m", 1e-3, 1e9, 20000.0, "of each point of the shell"};
}
inline rendering::ParameterDeclaration point_spacing_parameter() {
  return {"point_spacing_m", "m", 1e-6, 1.0, 1e-3, "between points of the shell"};
}

}  // namespace touchstone::tool_renderers
