// The experiments on simulated scans of a duck-like body, as subcommands of `touchstone experiment`: friction, density,
// shading. What runs throws UsageError for options that do not go together.
#pragma once

#include "apps/command.h"

namespace touchstone::studies {

void add_scan_experiments(CLI::App& experiment, apps::Run& run);

}  // namespace touchstone::studies
