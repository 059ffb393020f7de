// What an effect must pass to be added. The cheap gates come first and judge every trial, the costly ones the best,
// and the next one's turn comes when it fails.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/discrepancy/null_gains.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/discrepancy/trial.h"

namespace touchstone::discrepancy {

// Whether all that an effect does is to move the surface, by no more than the mesh's makers declare as its error.
bool within_mesh_error(const SearchState& state, const rendering::Model& model, const std::string& effect);

// Whether what the effect does to the surface, if it is a bump or a wave of its own, exceeds the mesh's declared error
// by the settings' margin for sure: by the 95 % interval of the fit's covariance and of the draws.
bool displaces_for_sure(const SearchState& state, const JointFit& fit, const std::vector<FreeParameter>& parameters,
                        const std::vector<NullFit>& draws, const std::string& effect);

// Passed: it gains more than noise, and matters.
TrialVerdict cheap_gates(const SearchState& state, const BaselineScore& baseline, const Trial& trial);

// Passed: it makes no regime worse, helps on the smoothed trajectory too, and is no declared error of the mesh.
TrialVerdict costly_gates(const SearchState& state, const Trial& trial);

// What the validation gain must exceed: the largest gain of any refit in the simulated null recordings, and more by
// the settings' deviations. Few recordings if they decide clearly, all of them if the gain is near the bar.
double null_threshold(const SearchState& state, const RefitInWorld& refits, double gain);
// Of one candidate.
double null_threshold(const SearchState& state, const rendering::Candidate& candidate, double gain);

inline constexpr const char* out_of_time = "not checked: the time limit ended the search";

inline constexpr const char* within_null = "no more than simulated recordings give in which nothing is missing";

// The verdict on what may be, or is, the mesh's declared error.
inline TrialVerdict within_mesh() {
  return {TrialVerdict::Kind::within_mesh_tolerance, "within the mesh's declared error"};
}
inline TrialVerdict maybe_within_mesh() {
  return {TrialVerdict::Kind::within_mesh_tolerance, "may be within the mesh's declared error"};
}
// The other trial that gains at least as much, though all it does may be the mesh's declared error: what that may
// explain is not missing. nullptr: none.
const Trial* explained_by_mesh(const std::vector<Trial>& trials, const Trial& trial);

// All gates in their order. Sets the trial's bar where it came to that.
TrialVerdict all_gates(const SearchState& state, const BaselineScore& baseline, Trial& trial);

}  // namespace touchstone::discrepancy
