// What the main() of every program of this folder does: parses, dispatches, and turns errors into a message on stderr
// and an exit status.
#pragma once

#include <string>
#include <vector>

#include "apps/command.h"

namespace touchstone::apps {

// A command and its options, in a process that goes on afterwards. Errors are thrown with the message that the program
// would print; what cannot be parsed is a UsageError. `words` begin with the command's name.
ExitStatus run_words(const std::vector<std::string>& words, const std::vector<AddCommand>& commands);

int run_program(int argc, char** argv, const std::vector<AddCommand>& commands);

// The same for an extra, whose name is the command (apps/extras.h): touchstone-blind runs `blind`. Bundled files and
// the program that runs again are those of the `touchstone` that started it, else of the one beside it.
int run_extra(int argc, char** argv, const std::vector<AddCommand>& commands);

}  // namespace touchstone::apps
