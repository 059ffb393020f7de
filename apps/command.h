// A command of the program `touchstone`: one pair of files each, joined in the catalogue of main.cc.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "harness/base/error.h"

namespace touchstone::apps {

// Adds the subcommand to the program; when the user chose it, sets `run` to what does the work.
using Run = std::function<ExitStatus()>;
using AddCommand = void (*)(CLI::App& program, Run& run);

// How the program was called, for provenance.
const std::vector<std::string>& command_line();

}  // namespace touchstone::apps
