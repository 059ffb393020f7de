// Two effects at once, where something is clearly missing and no single candidate passes: each alone may bend to make
// up for the other, make a regime worse, or be lost in what the other leaves (forward selection's known blind spot;
// Miller, Subset Selection in Regression, 2002, chapter 3.11). The best candidates by training gain are assumed known
// one by one and the second effect is fitted on what remains. A pair that is most of what is missing is judged by the
// gates of one effect, as a whole and each of the two with the other known.
#pragma once

#include <vector>

#include "harness/discrepancy/trial.h"

namespace touchstone::discrepancy {

// Pairs tried, the best first; the one whose verdict is empty passed. `singles`: the trials of the step that none of
// passed.
std::vector<Trial> try_pairs(const SearchState& state, const BaselineScore& baseline,
                             const std::vector<Trial>& singles);

}  // namespace touchstone::discrepancy
