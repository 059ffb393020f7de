// A law for what no effect of the library explains: terms of a library over what the recording holds (law_library.h),
// chosen one after the other as in forward regression (Chen, Billings and Luo 1989, Int. J. Control 50:1873).
//
// Every term at every start is regressed on what the model leaves of the training blocks, beside all that is free in
// the model, and scored on the validation blocks. The bar is the largest gain of any of them in simulated recordings
// where nothing is missing (max statistic: Westfall and Young 1993): this many terms find something by chance, and the
// bar knows it. The best few are fitted with all that is free; blocks are weighed by the noise and by what each leaves
// itself, so that the weights sharpen as the law takes shape, and compared by likelihood on the validation blocks. The
// same is done from the model before anything was found, and the Bayesian information criterion chooses (Schwarz 1978,
// Ann. Statist. 6:461): effects of the library that only came near are then no part of it. A law is empirical: it says
// what the force follows, not why.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/discrepancy/law_library.h"
#include "harness/discrepancy/search_state.h"

namespace touchstone::discrepancy {

// Of one variable, over the samples that were learnt from.
struct SeenRange {
  std::string variable;  // "depth", "sliding speed", "x", ...
  std::string unit;
  double low = 0.0;
  double high = 0.0;
};

struct LawPiece {
  std::shared_ptr<const rendering::DeclaredEffect> effect;  // parameters start at the fitted values
  rendering::Side side = rendering::Side::contact;
  std::vector<Carrier> carriers;
  double validation_gain = 0.0;  // of chi-squared, by the regression
  double null_threshold = 0.0;   // the largest gain in null recordings, and more
};

struct UnknownLaw {
  std::vector<LawPiece> pieces;       // empty: no law was found
  rendering::Model model;             // the effects that are needed beside it, and the law
  std::vector<std::string> needless;  // effects that were found and are not needed beside the law
  std::vector<SeenRange> seen;
  [[nodiscard]] bool found() const { return !pieces.empty(); }
};

// Of the squared error beyond noise that a law must remove: what leaves more is no law of it.
constexpr double least_law_share = 0.25;

// Whether the found model leaves something on the validation blocks: more than noise, or structure.
bool calls_for_law(const SearchState& found);

// `base`: the model with its stiffness refitted and nothing found. Both are fitted; the held-out data are not looked
// at.
UnknownLaw search_law(const SearchState& found, const rendering::Model& base,
                      const std::function<void(const std::string&)>& report);

}  // namespace touchstone::discrepancy
