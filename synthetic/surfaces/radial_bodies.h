// The closed bodies whose radius is a function of direction (star-shaped): bumpy and duck.
#pragma once

#include <memory>

#include "synthetic/surfaces/radial_body.h"

namespace touchstone::synthetic {

// r(x, y, z) = R (1 + 0.30 x y + 0.08 sin(3x + 1) cos(2z) + 0.05 sin(5y)) over unit directions (x, y, z): the body on
// which two other libraries were measured (R = 30 mm).
std::unique_ptr<RadialBody> bumpy_body(double radius_m);

// A bath duck in the spirit of the 2006 paper's object, not a copy of it: an ellipsoidal body with a head, a bill and a
// tail, smooth everywhere. r(u) = L (1 / sqrt(u'Qu) + sum a_i exp(k_i (u . d_i - 1))) with L half the body's length;
// the lobes are bells on the sphere (von Mises-Fisher).
std::unique_ptr<RadialBody> duck_body(double half_length_m);

}  // namespace touchstone::synthetic
