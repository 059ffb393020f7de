// The unit of a clock, from its name, the lines above it and its numbers: seconds since 1970 have nine more digits in
// nanoseconds; a recording has a rate between 1 Hz and 1 MHz.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "column_name.h"
#include "head_facts.h"

namespace touchstone::importing {

struct ClockReading {
  std::optional<double> scale;  // to seconds; nothing where it is not certain
  std::string reason;           // why it is that, or what is to be decided
  bool stands = false;          // its numbers do not increase: it is none
};

ClockReading read_clock(const std::vector<double>& values, const ColumnName& name, const HeadFacts& head);
// Whether it counts rows: by ones.
bool counts_rows(const std::vector<double>& values);
// Whether its numbers are those of a clock since 1970.
bool is_since_1970(const std::vector<double>& values);

}  // namespace touchstone::importing
