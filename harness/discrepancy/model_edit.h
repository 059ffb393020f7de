// Models with an effect more or less, and the free parameters that go with them.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "harness/discrepancy/candidate_starts.h"
#include "harness/discrepancy/effect_library.h"
#include "harness/discrepancy/joint_fit.h"

namespace touchstone::discrepancy {

// What every fit is free to change: the base renderer's stiffness. Throws BadData where the model has none.
FreeParameter base_stiffness(const rendering::Model& start);

rendering::Model with_entry(const rendering::Model& model, rendering::Side side,
                            const rendering::NamedParameters& entry);
rendering::Model without_entry(const rendering::Model& model, const std::string& name);
std::vector<FreeParameter> without_owner(const std::vector<FreeParameter>& parameters, const std::string& name);

// Whether friction turns over a path that is fitted.
bool has_path(const rendering::NamedParameters& entry);
bool has_path(const rendering::Model& model);
// The model with that path at a third and a tenth, and the window over which an acceleration is taken at 0.6 and 0.4;
// none without either. A tracker's noise makes a fit prefer a longer path than the tip has, and a longer window than
// the tool's quickest motions ask for: what the longer one leaves out is within the noise of the shorter one.
std::vector<rendering::Model> with_shorter_paths(const rendering::Model& model);

// The same wave has many names: its direction is taken in [0, pi), its phase in [0, 2 pi).
void settle_waves(rendering::Model& model, const EffectLibrary& library);

// How long a fit is pursued.
struct FitEffort {
  int iterations = 0;
  int each_start = 0;  // iterations from each of several starts, before the best one is finished
  // Of chi-squared: a fit that will not come below it is not finished (see fit_jointly_below).
  double abandon_above = std::numeric_limits<double>::infinity();
};

// The best fit of `current` with the candidate over all the candidate's starts: a few steps from each, with what moves
// the contact kept, the best one finished with all free. `parameters`: what is free in `current`; those of the
// candidate are added.
JointFit best_fit(const FitData& data, const rendering::Model& current, const CandidateFit& candidate,
                  std::vector<FreeParameter> parameters, const FitEffort& effort);
// A third of the iterations from each start.
JointFit best_fit(const FitData& data, const rendering::Model& current, const CandidateFit& candidate,
                  std::vector<FreeParameter> parameters, int iterations);

}  // namespace touchstone::discrepancy
