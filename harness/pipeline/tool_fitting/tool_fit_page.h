// The page of a fit of the instrument with a tool: what was found, force and torque over time before and after.
#pragma once

#include "harness/pipeline/tool_fitting/tool_fit.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::pipeline {

report::Page tool_fit_page(const recording::Recording& measured, const ToolFit& fit,
                           const report::Provenance& provenance);

}  // namespace touchstone::pipeline
