// The god-object renderer: Zilles and Salisbury, "A constraint-based god-object method for haptic display", IROS 1995.
#pragma once

#include "harness/rendering/renderer_entry.h"

namespace touchstone::renderers {

rendering::RendererEntry god_object_entry();

}  // namespace touchstone::renderers
