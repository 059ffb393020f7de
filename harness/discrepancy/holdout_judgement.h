// The held-out data's one use: once names, values and intervals stand, what they leave there, and what each effect
// gains there. No name, value or interval depends on it; that something is missing there is a reason to seek a law.
#pragma once

#include "harness/discrepancy/effect_search.h"

namespace touchstone::discrepancy {

// Fills in what `result` says of held-out data, from its model, parameters, draws and found effects: goodness with its
// thresholds, structure and spectrum of the residual by the declared noise, and each effect's gain with its standard
// error, everything else having made up for it as far as it can in `iterations` of a fit; without the last where time
// is up.
void judge_on_holdout(const SearchData& data, int iterations, TimeBudget& budget, SearchResult& result);

// The gain there of a law that was learnt without them: a directed test, which sees what is too little for measures of
// the whole residual.
void judge_law_on_holdout(const SearchData& data, SearchResult& result);

}  // namespace touchstone::discrepancy
