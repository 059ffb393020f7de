// A Page as the JSON document that the script in the report draws from.
#pragma once

#include <string>

#include "harness/report/page.h"

namespace touchstone::report {

// Numbers that are not finite become null. Coordinates and plotted numbers are rounded to nine significant digits.
std::string page_to_json(const Page& page);

}  // namespace touchstone::report
