// The commands of this extra, for its program and for the Python module.
#pragma once

#include "apps/command.h"

namespace touchstone::studies {

void add_atlas(CLI::App& program, apps::Run& run);
void add_blind(CLI::App& program, apps::Run& run);
void add_experiment(CLI::App& program, apps::Run& run);
void add_sweep(CLI::App& program, apps::Run& run);

}  // namespace touchstone::studies
