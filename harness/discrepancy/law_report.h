// An empirical law in words, formulas and JSON, with what it does on held-out data.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "harness/discrepancy/law_search.h"

namespace touchstone::discrepancy {

// What the empirical law does on the held-out samples. RMS of the 3-D force error.
struct LawGap {
  double start_N = 0.0;    // of the start with its stiffness refitted
  double without_N = 0.0;  // with the effects found
  double with_N = 0.0;     // with the law
  // Of the square beyond what noise leaves of the start's.
  double closed = 0.0;
  double chi_squared_gain = 0.0;  // over the effects found
  double chi_squared_error = 0.0;
};

// "depth", "place and past of the motion": what the pieces of the law follow.
std::string law_follows(const UnknownLaw& law);
// Its formulas, a line each: "empirical-layer: normal_N = k * max(0, depth_m - from)".
std::vector<std::string> law_formulas(const UnknownLaw& law);

// "empirical_law" of findings.json.
nlohmann::ordered_json law_json(const UnknownLaw& law, const LawGap& gap);

}  // namespace touchstone::discrepancy
