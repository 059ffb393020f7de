// Are tip and object where each other's files say? Load where the model has no object is a missing tip radius, a
// registration that is off, or another object.
#pragma once

#include <optional>

#include "harness/recording_checks/check_recording.h"

namespace touchstone::recording_checks {

// "registration": a remark if 19 of 20 samples that push have the tip outside of the object (a tip radius is missing),
// or if more than a tenth of the load is measured beyond the edge of an open mesh or outside of the object.
// For the first, lengths below half a per cent of the object's diagonal count as contact, for the second below 2 %.
// `touching_N`: smaller forces are noise.
std::optional<RecordingFinding> find_misplacement(const recording::Recording& recording,
                                                  const RecordingContext& context, double touching_N,
                                                  double noticed_share_of_load = 0.1);

// "no contact": the tip never reaches the object and no force is above the context's threshold of contact.
std::optional<RecordingFinding> touches_nothing(const recording::Recording& recording, const RecordingContext& context);

}  // namespace touchstone::recording_checks
