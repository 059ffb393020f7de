// The gap again, from the written model alone and in a process of its own.
#pragma once

#include <optional>

#include "apps/discrepancy/inputs.h"
#include "harness/base/rooms.h"

namespace touchstone::apps {

// RMS of the 3-D force error of `files.model` against all of `files.recording`, from the files alone.
double rms_of_files_N(const DiscrepancyFiles& files);

// The same by a fresh run of this program. Nothing where the system cannot start one; throws BadData when the run
// fails.
std::optional<double> rms_in_fresh_process_N(const DiscrepancyFiles& files);

}  // namespace touchstone::apps
