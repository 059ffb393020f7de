// Whether a recording and a mesh can belong together: a mesh in millimetres read as metres is the commonest mistake of
// all.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "harness/surface/surface.h"

namespace touchstone::rendering {

// A message for the user when the tip positions (best: those in contact) do not lie where the surface is; nothing when
// they do. It names the two boxes and, where scaling the mesh by a usual unit would fit, asks for that unit.
//
// Rule: d is the median distance (less the tip radius) of at most 1000 of the positions, evenly taken; r is the same
// after the depth that the loads explain, so many metres for each newton, is taken off. They are nowhere near when d
// exceeds the diagonal of the surface's box, or the diagonal of the positions' box and 1/20 of the surface's, unless
// the tool is held in the air and no unit fits. They are off it when a unit fits and r exceeds 1/20 of the positions'
// diagonal, or 1/100 and 30 times what it is in that unit. A unit fits when r for the mesh in that unit is less than a
// tenth of what it was; the one with the smallest r is named. So a large floor that is touched at a small place passes
// in every unit in which it is there. `loads_N`: the sizes of the forces at the positions; empty: not known.
// `recording` and the surface's mesh source name the two in the message; `mesh_unit` is the unit that was assumed.
std::optional<std::string> far_from_surface(const surface::Surface& surface, std::span<const Vec3> tips_W_m,
                                            std::span<const double> loads_N, double tip_radius_m,
                                            const std::string& recording, const std::string& mesh_unit);

// The same for positions without forces, which may lie anywhere: a message only where they are nowhere near the
// surface, deep within it or far outside, and there is a unit in which the path, as long as it is, would touch.
std::optional<std::string> fits_another_unit(const surface::Surface& surface, std::span<const Vec3> tips_W_m,
                                             double tip_radius_m, const std::string& recording,
                                             const std::string& mesh_unit);

// Whether the tip is held beside the object, as when a tool is turned to be weighed: it moves by less than a hundredth
// of the object's size, between a twentieth and the whole of that size away from its surface. What such a recording
// says of contact is nothing.
bool held_in_the_air(const surface::Surface& surface, std::span<const Vec3> tips_W_m, double tip_radius_m);

}  // namespace touchstone::rendering
