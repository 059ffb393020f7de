// Signs that the data, not the model, are wrong: forces that do not follow the positions, and coefficients that physics
// wants positive but the data negative (friction that pulls along, a tool that weighs less than nothing, damping that
// drives). Such a recording is blamed, and nothing is named.
#pragma once

#include <optional>
#include <string>

#include "harness/discrepancy/structure_detector.h"

namespace touchstone {

// `base`: the starting model refitted; `best`: what the search found. Nothing when the data may be right.
std::optional<std::string> find_data_fault(const DetectorSide& train, const DetectorSide& holdout, const Model& base,
                                           const Model& best);

}  // namespace touchstone
