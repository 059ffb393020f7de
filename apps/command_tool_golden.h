// `touchstone tool golden`, a command of `touchstone tool`.
#pragma once

#include "apps/command.h"

namespace touchstone::apps {

void add_tool_golden(CLI::App& tool_command, Run& run);

}  // namespace touchstone::apps
