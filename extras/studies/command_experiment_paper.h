// The four experiments of Ruffaldi et al. 2006 on any data, as subcommands of `touchstone experiment`. What runs throws
// UsageError for options that do not go together.
#pragma once

#include "apps/command.h"

namespace touchstone::studies {

void add_paper_experiment(CLI::App& experiment, apps::Run& run);

}  // namespace touchstone::studies
