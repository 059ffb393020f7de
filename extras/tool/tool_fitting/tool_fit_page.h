// The page of a fit of the instrument with a tool: what was found, force and torque over time before and after.
#pragma once

#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "tool_fitting/tool_fit.h"

namespace touchstone::tool_fitting {

report::Page tool_fit_page(const recording::Recording& measured, const ToolFit& fit,
                           const report::Provenance& provenance);

}  // namespace touchstone::tool_fitting
