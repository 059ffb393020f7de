// Units as instruments write them, by the database of UDUNITS-2 (UCAR/Unidata: SI, its prefixes, inch-pound and
// accepted units, with the dimension of each), with spellings of the trade that it lacks: Nm, Nmm, kp, deg, in-lb. A
// unit that is not known, or is one of another dimension, has no factor: nothing is assumed for it. Throws
// BadData where the library's database is not installed.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace touchstone::importing {

// From `written` ("lbf", "N-mm", "µm") to the SI unit `si` ("N", "N.m", "m", "s", "rad"). Nothing if it is no unit of
// that dimension. "1/s" is none of a time, "counts" none of an angle.
std::optional<double> foreign_unit_factor(std::string_view written, std::string_view si);
// Whether it is a unit of any dimension; a number or nothing is none.
bool is_foreign_unit(std::string_view written);
// Text in Latin-1, as loggers of Windows write "µ", as UTF-8; UTF-8 stays as it is.
std::string as_utf8(std::string_view text);

}  // namespace touchstone::importing
