// The command `touchstone acquire`, for its program and for the Python module.
#pragma once

#include "apps/command.h"

namespace touchstone::acquisition {

void add_acquire(CLI::App& program, apps::Run& run);

}  // namespace touchstone::acquisition
