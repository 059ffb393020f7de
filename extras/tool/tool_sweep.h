// A sweep of renderers of tools with a shape: each case is one contact whose answer is known, rendered by one renderer,
// and its row holds how far off the renderer is (tool_errors.h). The specification (extras/runs/design.h):
//   {"schema": "touchstone-tool-sweep/1", "design": "grid",
//    "contacts": {"corner": {"case": "box-corner"}},
//    "renderers": {"voxels": {"renderer": "voxmap-pointshell", "parameters": {"voxel_m": 5e-4},
//                             "stiffness_N_per_m": 1000, "rotational_stiffness_Nm_per_rad": 2}},
//    "vary": [{"set": "/renderer/parameters/voxel_m", "values": [2.5e-4, 5e-4]},
//             {"set": "/contacts/scale", "values": [0.5, 1, 2]}]}
// A contact has a "scale" (1) and, if it is a "peg", a "clearance_m".
#pragma once

#include "case_engine.h"
#include "design.h"

namespace touchstone::tool {

runs::DesignParts tool_sweep_parts();
runs::CaseTable tool_sweep_table(const runs::SweepDesign& design);
// It must live as long as the job. A case that cannot be run is a row with its error.
runs::CaseJob tool_sweep_job(const runs::SweepDesign& design);

}  // namespace touchstone::tool
