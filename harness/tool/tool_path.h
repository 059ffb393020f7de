// A straight way of the handle between two poses, and runs of a renderer along it.
#pragma once

#include "harness/rendering/renderer_failed.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

// The pose at `share` (0 to 1) of the way: the origin on a straight line, the rotation about one axis at one rate.
inline Pose between(const Pose& from, const Pose& to, double share) {
  const Displacement way = displacement(from, to);
  return moved(from, {share * way.translation_m, share * way.rotation_rad});
}

// One step; throws RendererFailed when the renderer breaks down.
inline ToolResult step_or_throw(ToolRenderer& renderer, const ToolState& state) {
  const ToolResult result = renderer.step(state);
  if (result.status == ToolStatus::failed) throw rendering::RendererFailed(renderer.failure());
  return result;
}

// Resets the renderer, takes the handle from `from` to `to` in 0.4 s and holds it there for 0.4 s, at 1 kHz. Returns
// the last step's answer; throws as step_or_throw() does. A proxy without mass rests long before; one with the mass of
// a tool rests within its damping.
inline ToolResult settle(ToolRenderer& renderer, const Pose& from, const Pose& to) {
  constexpr int moving = 400;
  constexpr int holding = 400;
  renderer.reset();
  ToolResult result;
  for (int i = 0; i <= moving + holding; ++i) {
    const double share = i < moving ? double(i) / moving : 1.0;
    result = step_or_throw(renderer, {1e-3 * i, between(from, to, share)});
  }
  return result;
}

// Settles at `pressed` and goes on to `to` in 0.8 s. Returns the answer to the last step, on the way still.
inline ToolResult slide(ToolRenderer& renderer, const Pose& from, const Pose& pressed, const Pose& to) {
  constexpr int sliding = 800;
  settle(renderer, from, pressed);
  ToolResult result;
  for (int i = 1; i <= sliding; ++i)
    result = step_or_throw(renderer, {1.0 + 1e-3 * i, between(pressed, to, double(i) / sliding)});
  return result;
}

}  // namespace touchstone::tool
