// A sweep as cases for the engine (harness/runs/case_engine.h) and as rows of its store.
#pragma once

#include "apps/sweep/world.h"
#include "harness/base/rooms.h"
#include "harness/runs/case_engine.h"

namespace touchstone::apps {

CaseTable sweep_table(const SweepDesign& design);
// Both must live as long as the job.
CaseJob sweep_job(const SweepDesign& design, SweepWorld& world);
CaseRow sweep_row(const SweepOutcome& outcome);

}  // namespace touchstone::apps
