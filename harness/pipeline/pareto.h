// The renderers that no other one beats: what remains to choose from if error, felt error, operations and time count
// at once.
#pragma once

#include <vector>

namespace touchstone::pipeline {

// costs[i]: what one candidate costs, less is better, all with the same number of entries. true: no other candidate is
// at most as expensive in everything and cheaper in something. A candidate with a cost that is not a number is not on
// the front and beats nobody.
std::vector<bool> pareto_front(const std::vector<std::vector<double>>& costs);

}  // namespace touchstone::pipeline
