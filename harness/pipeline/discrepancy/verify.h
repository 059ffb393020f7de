// The gap of a search for missing effects, computed again from the files alone that it wrote.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "harness/pipeline/discrepancy/inputs.h"

namespace touchstone::pipeline {

// RMS of the 3-D force error of `files.model` against all of `files.recording`, from the files alone. `report` gets
// what there is to say on mesh and recording.
double rms_of_files_N(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files,
                      const std::function<void(const std::string&)>& report = {});

// The same by a fresh run of `files.program`, which is `touchstone`, with nothing said. Nothing if the system cannot
// start it; throws BadData, with what the run said, if it fails.
std::optional<double> rms_in_fresh_process_N(const DiscrepancyFiles& files);

}  // namespace touchstone::pipeline
