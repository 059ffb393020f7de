// The commands of this extra, for its program.
#pragma once

#include "apps/command.h"

namespace touchstone::dashboard {

void add_dashboard(CLI::App& program, apps::Run& run);
void add_history(CLI::App& program, apps::Run& run);

}  // namespace touchstone::dashboard
