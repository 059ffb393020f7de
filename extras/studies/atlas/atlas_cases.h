// The atlas as cases for the engine (extras/runs/case_engine.h), as rows of its store, and as the words of its
// command.
#pragma once

#include "atlas/atlas.h"
#include "case_engine.h"

namespace touchstone::atlas {

runs::CaseTable atlas_case_table(const AtlasGrid& grid);
// The world must live as long as the job.
runs::CaseJob atlas_job(const AtlasGrid& grid, AtlasWorld& world);
// Of a store that has all of them, in their order.
std::vector<AtlasCase> stored_cases(const AtlasGrid& grid, const runs::CaseStore& store);
// {"atlas", "--renderers", ...}: the call that asks for this grid.
std::vector<std::string> atlas_words(const AtlasGrid& grid);
// {"scene", ...} of one case, as JSON: a line of --dry-run.
std::string describe_case(const AtlasGrid& grid, std::uint64_t number);

}  // namespace touchstone::atlas
