// A straight way of the handle between two poses, and runs of a renderer along it.
#pragma once

#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

// The pose at `share` (0 to 1) of the way: the origin on a straight line, the rotation about one axis at one rate.
inline Pose between(const Pose& from, const Pose& to, double share) {
  const Displacement way = displacement(from, to);
  return moved(from, {share * way.translation_m, share * way.rotation_rad});
}

// Resets the renderer, takes the handle from `from` to `to` in 0.4 s and holds it there for 0.4 s, at 1 kHz. Returns
// the last step's answer. A proxy without mass rests long before; one with the mass of a tool rests within its damping.
inline ToolResult settle(ToolRenderer& renderer, const Pose& from, const Pose& to) {
  constexpr int kMoving = 400;
  constexpr int kHolding = 400;
  renderer.reset();
  ToolResult result;
  for (int i = 0; i <= kMoving + kHolding; ++i) {
    const double share = i < kMoving ? double(i) / kMoving : 1.0;
    result = renderer.step({1e-3 * i, between(from, to, share)});
  }
  return result;
}

}  // namespace touchstone::tool
