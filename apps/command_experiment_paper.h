// The four experiments of Ruffaldi et al. 2006 on any data.
#pragma once

#include "apps/apps_rooms.h"
#include "apps/command.h"

namespace touchstone::apps {

void add_paper_experiment(CLI::App& experiment, Run& run);

}  // namespace touchstone::apps
