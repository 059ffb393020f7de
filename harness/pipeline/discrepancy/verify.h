// The gap of a search for missing effects, computed again from the files alone that it wrote.
#pragma once

#include <optional>

#include "harness/pipeline/discrepancy/inputs.h"
#include "harness/pipeline/pipeline_rooms.h"

namespace touchstone::pipeline {

// RMS of the 3-D force error of `files.model` against all of `files.recording`, from the files alone.
double rms_of_files_N(const Catalogue& catalogue, const DiscrepancyFiles& files);

// The same by a fresh run of `files.program`, which is `touchstone`. Nothing if the system cannot start it; throws
// BadData if the run fails.
std::optional<double> rms_in_fresh_process_N(const DiscrepancyFiles& files);

}  // namespace touchstone::pipeline
