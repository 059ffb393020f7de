// The experiments on simulated scans of a duck-like body: friction, density, shading.
#pragma once

#include "apps/apps_rooms.h"
#include "apps/command.h"

namespace touchstone::apps {

void add_scan_experiments(CLI::App& experiment, Run& run);

}  // namespace touchstone::apps
