// The god-object with force shading.
//
// Source: H. B. Morgenbesser and M. A. Srinivasan, "Force shading for haptic shape perception", ASME DSC-Vol. 58, 1996:
// two passes. The first finds contact and the size of the force as without shading; the second turns the force to the
// normal interpolated between the vertices' (shaded_normals.h), its size kept. With friction (cone_friction.h) the
// whole force turns with the normal, by the rotation that takes the one to the other the shortest way: the cone then
// stands about the shaded normal. (Ruspini, Kolarov and Khatib 1997 move the proxy by the shaded planes instead, which
// changes the size of the force by 1/cos of the angle; that is not done here.)
//
// Parameters stiffness_N_per_m, tip_radius_m, mu_static, mu_dynamic, crease_angle_rad: edges sharper than that are not
// shaded. A ball held by several triangles feels their shaded normals in the proportion in which they press.
//
// Limits, which come of the method:
//  - it is not conservative. The proxy stores k/2 d^2 and takes its change from the hand's work exactly; the turned
//    force works k d (n_s - n) . dp beside it, so that a path of length L at depth up to d through shading of up to the
//    angle a can give back up to k d 2 sin(a/2) L, and a loop about a place where the interpolated normals twist gives
//    some at every round. It adds up to nothing to first order where the normals are a smooth surface's.
//  - on concave edges below the crease angle the force points to the interpolated normal wherever between the two faces
//    the tip pulls.
//  - along a rim the mean is one-sided.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry force_shading_entry();

}  // namespace touchstone::renderers
