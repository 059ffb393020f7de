// Where an object feels another: the judge's map of places (perception/judge/place.h) as a picture seen along the
// direction of pressing, the forces along the longer side, and every place in figures.
#pragma once

#include <vector>

#include "harness/perception/judge/judged_conditions.h"
#include "harness/report/page.h"

namespace touchstone::report {

// Empty, without blocks, where no process was pressed at more than one place.
std::vector<Section> place_sections(const perception::JudgedConditions& judged);

}  // namespace touchstone::report
