// The commands of this extra, for its program and for the Python module.
#pragma once

#include "apps/command.h"

namespace touchstone::datasets {

void add_dataset(CLI::App& program, apps::Run& run);
void add_synth(CLI::App& program, apps::Run& run);

}  // namespace touchstone::datasets
