// The surfaces and motions of this folder's catalogues, for golden cases and sweeps that name them.
#pragma once

#include "harness/rendering/generators.h"

namespace touchstone::synthetic {

const rendering::Generators& built_in_generators();

}  // namespace touchstone::synthetic
