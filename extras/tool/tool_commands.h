// The command of this extra and the commands below it.
#pragma once

#include "apps/command.h"

namespace touchstone::tool {

void add_tool(CLI::App& program, apps::Run& run);

// Below `tool`.
void add_atlas(CLI::App& tool_command, apps::Run& run);
void add_fit(CLI::App& tool_command, apps::Run& run);
void add_golden(CLI::App& tool_command, apps::Run& run);
void add_scorecard(CLI::App& tool_command, apps::Run& run);
void add_sweep(CLI::App& tool_command, apps::Run& run);

}  // namespace touchstone::tool
