// The command of this extra, for its program and for the Python module.
#pragma once

#include "apps/command.h"

namespace touchstone::board {

void add_leaderboard(CLI::App& program, apps::Run& run);

}  // namespace touchstone::board
