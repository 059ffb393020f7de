// A map's scales against the units that the file itself states: a program in which the operator chooses the unit writes
// the next file in another one, and the map of the last would read it wrong by thousands.
#pragma once

#include <string>

#include "import_map.h"
#include "import_table.h"

namespace touchstone::importing {

// Throws BadData where the name of the table's column (or a row of units below it) states a unit of the quantity that
// `result` ("z_mm", "fx_N") is of, from which another scale than the term's leads to it. Signs are the map's matter.
void check_unit_of_term(const ImportTable& table, std::size_t column, const ImportTerm& term, const std::string& result,
                        const std::string& map_source);

}  // namespace touchstone::importing
