// Springs on a surface: the two rendering models of Shao, Wu and Ouyang (section 3), F = k dx and F = k dx^2, dx the
// depth of the tip below the closest surface point. F = k dx is also the vector-field method that Zilles and Salisbury
// (1995) argue against: without a memory of where the tip came in, a tip that passes the middle of a thin body is
// pushed out on the other side. It is here for presses, and to show what the methods with memory gain.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry spring_linear_entry();
rendering::RendererEntry spring_quadratic_entry();

}  // namespace touchstone::renderers
