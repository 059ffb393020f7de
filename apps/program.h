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

// The main() of an extra (extras.h): its name, touchstone-NAME, is the command, which is how `touchstone NAME` finds
// it. Bundled recordings are found, and parts of the work started, from the program that started this one, else from
// the one beside it.
int run_extra(int argc, char** argv, const std::vector<AddCommand>& commands);

}  // namespace touchstone::apps
