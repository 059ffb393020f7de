// What an effect must pass to be added. The cheap gates come first and judge every trial; the dear ones only the best,
// and the next one's turn comes when it fails.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/trial.h"

namespace touchstone {

// Empty: it gains more than noise, and matters.
std::string weakness(const SearchState& state, const Standing& standing, const Trial& trial);

// Empty: it makes no regime worse, helps along the likely motion too, and is no error that the mesh's makers declare.
std::string objection(const SearchState& state, const Trial& trial);

// What the held-out gain must exceed: the most that any of the refits gains in the case's null worlds, and more by the
// settings' deviations. Few worlds where they decide clearly, all of them where the gain is near the bar.
double null_bar(const SearchState& state, const RefitInWorld& refits, double gain);
// Of one candidate.
double null_bar(const SearchState& state, const Candidate& candidate, double gain);

inline constexpr const char* within_null =
    "no more than noise and the mesh's declared error give where nothing is missing";

// All gates in their order. Sets the trial's bar where it came to that.
std::string refusal(const SearchState& state, const Standing& standing, Trial& trial);

}  // namespace touchstone
