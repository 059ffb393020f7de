// `touchstone tool atlas`: where renderers of tools are off by more than a person notices.
#pragma once

#include <CLI/CLI.hpp>

#include "apps/command.h"

namespace touchstone::apps {

void add_tool_atlas(CLI::App& tool_command, Run& run);

}  // namespace touchstone::apps
