// The options of every command that runs many cases: where their rows stand, how they are shared among machines, and
// which of them run here.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "apps/command.h"
#include "case_command.h"
#include "harness/report/provenance.h"

namespace touchstone::runs {

// `cases`: what they are, "cases" or "seeds".
void add_case_flags(CLI::App& command, CaseOptions& options, const std::string& cases);
// --cases and --any-build: for commands that make a report of the rows.
void add_case_file_flags(CLI::App& command, CaseOptions& options, const std::string& without);

// SPEC, --out and the options above, for a command that runs the cases of a design (extras/runs/design.h). `formats`:
// of the SPEC. Without --out the results stand beside the SPEC.
using RunDesign = std::function<ExitStatus(const std::string& specification, const CaseOptions& options)>;
void add_design_flags(CLI::App& command, apps::Run& run, const std::string& formats, const RunDesign& run_design);

// The rows that a report is made of, by their content hash.
report::InputFile stored_rows(const CaseStore& store, const CaseOptions& options);

}  // namespace touchstone::runs
