// A renderer outside Touchstone's tree, in C++ with its library: F = k dx up to the largest force that a device can
// give.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace example {

touchstone::rendering::RendererEntry saturating_spring_entry();

}  // namespace example
