// `touchstone loop` and the commands below it: each adds itself to the program.
#pragma once

#include "apps/command.h"

namespace touchstone::loop {

void add_loop(CLI::App& program, apps::Run& run);

// Below `touchstone loop`.
void add_atlas(CLI::App& loop, apps::Run& run);
void add_fit(CLI::App& loop, apps::Run& run);
void add_tune(CLI::App& loop, apps::Run& run);
void add_width(CLI::App& loop, apps::Run& run);

}  // namespace touchstone::loop
