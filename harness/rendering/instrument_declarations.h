// The instrument entries that a model file may hold: how the measurement was made. Renderers do not run them; whoever
// compares with a measurement does.
#pragma once

#include <vector>

#include "harness/rendering/parameters.h"

namespace touchstone {

const std::vector<NamedDeclaration>& instrument_declarations();

}  // namespace touchstone
