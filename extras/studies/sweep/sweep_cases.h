// A sweep as cases for the engine (extras/runs/case_engine.h) and as rows of its store.
#pragma once

#include "case_engine.h"
#include "sweep/world.h"

namespace touchstone::sweep {

runs::CaseTable sweep_table(const runs::SweepDesign& design);
// Both must live as long as the job.
runs::CaseJob sweep_job(const runs::SweepDesign& design, SweepWorld& world);
runs::CaseRow sweep_row(const SweepOutcome& outcome);

}  // namespace touchstone::sweep
