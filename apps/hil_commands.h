// Subcommands of `touchstone hil` that have a file of their own.
#pragma once

#include "apps/command.h"

namespace touchstone::apps {

void add_hil_render(CLI::App& hil_command, Run& run);

}  // namespace touchstone::apps
