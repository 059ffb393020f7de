// The implicit renderer: a slow reference for smooth shapes that knows the surface only as the zero level of a field.
//
// Source: K. Salisbury and C. Tarr, "Haptic rendering of surfaces defined by implicit functions", ASME Dynamic Systems
// and Control Division, DSC-Vol. 61, 1997: the surface contact point is found by Newton iterations on the field,
//   x <- x - S(x) grad S(x) / |grad S(x)|^2,
// and follows the tip by turns: the tip is projected on the tangent plane at the surface contact point, and from there
// Newton iterations lead back to the zero level, until the point stays. It remembers where it was, so that it does not
// pop through. The first contact is found by marching along the tip's way by the value of the field (J. C. Hart,
// "Sphere tracing", The Visual Computer 12, 1996), so that a jump through a body is seen.
//
// The field: on an analytic surface its signed distance; on a mesh samples of the signed distance (signed_field.h).
// A ball tip is the point on the level of its radius. Converges while the tip is nearer to the surface contact point
// than the radius of curvature there.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry implicit_entry();

}  // namespace touchstone::renderers
