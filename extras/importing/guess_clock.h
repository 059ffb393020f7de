// Which column of a file is the clock of its samples, or which rate its head states; asked where neither is certain.
#pragma once

#include "guess_proposal.h"

namespace touchstone::importing {

// Uses or asks for t_s. True where no name tells of a clock, so that the numbers are to be looked at.
bool clock_by_names(MapProposal& map);
// Without a name a clock is sure only where its numbers are seconds since 1970; others are asked about.
void clock_by_numbers(MapProposal& map, const ImportTable& table);
// Whether the proposal's orientations follow one another as along a path, and not as poses in no order.
bool moves_on(const MapProposal& map);

}  // namespace touchstone::importing
