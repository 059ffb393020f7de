// The options of every command that runs many cases: where their rows stand, how they are shared among machines, and
// which of them run here.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "harness/report/provenance.h"
#include "harness/runs/case_command.h"

namespace touchstone::apps {

// `cases`: what they are, "cases" or "seeds".
void add_case_flags(CLI::App& command, runs::CaseOptions& options, const std::string& cases);
// --cases and --any-build: for commands that make a report of the rows.
void add_case_file_flags(CLI::App& command, runs::CaseOptions& options, const std::string& without);

// The rows that a report is made of, by their content hash.
report::InputFile stored_rows(const runs::CaseStore& store, const runs::CaseOptions& options);

}  // namespace touchstone::apps
