// Signs that the data, not the model, are wrong: blocks of force in a wrong order, and coefficients that physics wants
// positive but the data negative (friction that pulls along, a tool that weighs less than nothing, damping that
// drives). Such a recording is blamed, and nothing is named. A load that does not vary, or that follows no position, is
// no fault: it is blamed only where another order of the blocks makes it follow.
#pragma once

#include <optional>
#include <string>

#include "harness/discrepancy/structure_detector.h"

namespace touchstone::discrepancy {

// Blocks of the force in another order than those of the position (see harness/recording_checks/block_order.h): the
// modelled load is `model`'s. Needs no search, and so may be asked before one. `side` is all that is learnt from: among
// the samples of every other block most blocks have no partner, and what clean data leave there is matched by chance.
std::optional<std::string> find_order_fault(const DetectorSide& side, const rendering::Model& model);

// Of coefficients alone. `base`: the starting model refitted; `best`: what the search found. Those of the candidates
// that are never negative (EffectTraits::OneSided) are sought, in their order. Nothing when the data may be right.
std::optional<std::string> find_coefficient_fault(const DetectorSide& train, const DetectorSide& holdout,
                                                  const rendering::Model& base, const rendering::Model& best,
                                                  const std::vector<rendering::Candidate>& candidates);

}  // namespace touchstone::discrepancy
