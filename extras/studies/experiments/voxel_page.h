// The report of the experiment that compares a proxy with a voxel renderer: error and cost over resolution.
#pragma once

#include "experiments/voxel_experiment.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

report::Page voxel_page(const VoxelExperiment& experiment, const report::Provenance& provenance);

}  // namespace touchstone::experiments
