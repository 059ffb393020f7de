// How much of the disagreement each part of an explanation takes away: the mean square of the held-out force error,
// shared among the refitted stiffness and the effects found by Shapley's value (Shapley 1953; of explained variance:
// Lipovetsky and Conklin 2001), the mean over all orders in which the parts can be added. The shares add up to exactly
// what goes, in whatever order the search found the parts. A share is negative where a part is of use only to make up
// for another one.
#pragma once

#include <string>
#include <vector>

#include "harness/discrepancy/evidence.h"

namespace touchstone::discrepancy {

struct GapShare {
  std::string name;     // of the effect, or "stiffness"
  double share = 0.0;   // of the mean square that the starting model leaves
  double left_N = 0.0;  // RMS that is left after this part and those before it, largest share first
};

// Largest share first. `end` is `start` with other values of its own parameters and with more effects, none of them
// refitted here. Parts: the parameters together, and every effect that `start` has not.
std::vector<GapShare> share_gap(const Evidence& evidence, const rendering::Model& start, const rendering::Model& end);

// As they are, or all as one ("a, b and c together") where a share is more than twice the whole gap, or takes more than
// the whole of it back: such parts only have a meaning together (a field of stiffness and the stiffness that it
// multiplies), and a share of one of them alone would mislead.
std::vector<GapShare> merge_inseparable(std::vector<GapShare> shares);

}  // namespace touchstone::discrepancy
