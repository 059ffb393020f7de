// The same case with its cause weaker: how small an effect may be and still be found.
#pragma once

#include "hidden_physics/blind_case.h"

namespace touchstone::hidden_physics {

// Every hidden effect at `strength` of its size, also in the answer: coefficients, amplitudes, masses, offsets and what
// an exponent differs from 1 by; a sensor saturates nearer to the largest force. Places, widths, ranges, velocities and
// times stay.
void weaken(BlindCase& plan, double strength);

}  // namespace touchstone::hidden_physics
