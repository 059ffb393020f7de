// `touchstone hil`, and those of its subcommands that have a file of their own.
#pragma once

#include <string>

#include "apps/command.h"
#include "devices/hardware_map.h"

namespace touchstone::hil {

using apps::Run;

void add_hil(CLI::App& program, Run& run);
void add_hil_record(CLI::App& hil_command, Run& run);
void add_hil_recover(CLI::App& hil_command, Run& run);
void add_hil_render(CLI::App& hil_command, Run& run);

// The file; without one, that which TOUCHSTONE_HARDWARE_MAP names.
HardwareMap hardware_map_from(const std::string& file);

}  // namespace touchstone::hil
