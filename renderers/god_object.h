// The god-object renderer: Zilles and Salisbury, "A constraint-based god-object method for haptic display", IROS 1995.
#pragma once

#include "renderers/catalogue.h"

namespace touchstone {

RendererEntry god_object_entry();

}  // namespace touchstone
