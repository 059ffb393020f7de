// The report page of one axis: what was found, the load over the place and over time, and where it came from.
#pragma once

#include <optional>

#include "axis_fit.h"
#include "axis_input.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::axis {

report::Page axis_page(const AxisInput& input, const AxisFit& fit, const std::optional<AxisFloor>& floor,
                       const report::Provenance& provenance);

}  // namespace touchstone::axis
