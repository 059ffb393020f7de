// The report page of one axis: what was found, the load over the place and over time, and where it came from.
#pragma once

#include <optional>

#include "harness/axis/axis_fit.h"
#include "harness/pipeline/axis/axis_input.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::pipeline {

report::Page axis_page(const AxisInput& input, const axis::AxisFit& fit, const std::optional<axis::AxisFloor>& floor,
                       const report::Provenance& provenance);

}  // namespace touchstone::pipeline
