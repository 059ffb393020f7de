// The timing of an engine whose force along the normal comes at once: a contact point that is late pulls sideways to
// where the tip was, and only while it slides. The tip slides to and fro at random over a level block, so that the
// sideways force of each sample of a period is told from the others': one that is late in some of them (a proxy that
// looks for one constraint a step), or held until the next update (a proxy at 60 Hz below a spring at 1 kHz).
#pragma once

#include "harness/renderer_faults/engine.h"
#include "harness/renderer_faults/timing.h"

namespace touchstone::renderer_faults {

Timing timing_of_slides(const Engine& engine);

}  // namespace touchstone::renderer_faults
