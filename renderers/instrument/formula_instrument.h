// An instrument entry that a user declared by formulas (harness/rendering/declared_effect.h): a force on the tool or an
// addition to the sensor's reading, by time, place, velocity and the force itself.
#pragma once

#include <span>

#include "harness/rendering/declared_effect.h"
#include "harness/rendering/measured_renderer.h"

namespace touchstone::renderers {

rendering::StagedInstrument make_formula_instrument(const rendering::DeclaredEffect& effect,
                                                    std::span<const double> values);

}  // namespace touchstone::renderers
