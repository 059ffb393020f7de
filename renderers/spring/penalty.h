// The penalty renderer: F = k d along the way to the closest surface point, d how deep the tip is; the tip is a point
// or a ball. It remembers nothing.
//
// Source: the penalty methods that Ruffaldi et al. 2006 describe in section 3.1, equation 1 (f = -k x), with the
// closest surface point as contact point: the vector-field method of Zilles and Salisbury 1995, section 2, whose faults
// are its known limits here: past the middle of a thin body it pushes the tip out at the far side, and the force jumps
// where two parts of the surface are equally near.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry penalty_entry();

}  // namespace touchstone::renderers
