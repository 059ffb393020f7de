// The table of a blind test: shares by set against their bars with 95 % intervals (Wilson 1927), the gap closed, the
// parameters' errors, how weak an effect is found, and every failure.
#pragma once

#include <string>
#include <vector>

#include "blind/blind_score.h"

namespace touchstone::blind {

struct BlindTable {
  std::string text;
  bool met = false;  // every bar that has a case
};
BlindTable blind_table(const std::vector<BlindScore>& scores);

}  // namespace touchstone::blind
