// A sweep as cases for the engine (harness/runs/case_engine.h) and as rows of its store.
#pragma once

#include "harness/base/rooms.h"
#include "harness/pipeline/sweep/world.h"
#include "harness/runs/case_engine.h"

namespace touchstone::pipeline {

CaseTable sweep_table(const SweepDesign& design);
// Both must live as long as the job.
CaseJob sweep_job(const SweepDesign& design, SweepWorld& world);
CaseRow sweep_row(const SweepOutcome& outcome);

}  // namespace touchstone::pipeline
