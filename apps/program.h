// What the main() of every program of this folder does: parses, dispatches, and turns errors into a message on stderr
// and an exit status.
#pragma once

#include <vector>

#include "apps/command.h"
#include "harness/base/rooms.h"

namespace touchstone::apps {

int run_program(int argc, char** argv, const std::vector<AddCommand>& commands);

}  // namespace touchstone::apps
