// The command `touchstone axis`, for its program and for the Python module.
#pragma once

#include "apps/command.h"

namespace touchstone::axis {

void add_axis(CLI::App& program, apps::Run& run);

}  // namespace touchstone::axis
