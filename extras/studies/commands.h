// The commands of this extra, as `touchstone experiment` and `touchstone blind`.
#pragma once

#include "apps/command.h"

namespace touchstone::studies {

void add_blind(CLI::App& program, apps::Run& run);
void add_experiment(CLI::App& program, apps::Run& run);

}  // namespace touchstone::studies
