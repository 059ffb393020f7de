// The experiments on simulated scans of a duck-like body: friction, density, shading.
#pragma once

#include "apps/command.h"
#include "harness/base/rooms.h"

namespace touchstone::apps {

void add_scan_experiments(CLI::App& experiment, Run& run);

}  // namespace touchstone::apps
