// A sweep as cases for the engine (apps/cases/case_engine.h) and as rows of its store.
#pragma once

#include "apps/cases/case_engine.h"
#include "apps/sweep/world.h"

namespace touchstone::apps {

CaseTable sweep_table(const SweepDesign& design);
// Both must live as long as the job.
CaseJob sweep_job(const SweepDesign& design, SweepWorld& world);
CaseRow sweep_row(const SweepOutcome& outcome);

}  // namespace touchstone::apps
