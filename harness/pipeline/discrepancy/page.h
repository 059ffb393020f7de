// The report of a search for missing effects, as a page.
#pragma once

#include "harness/discrepancy/findings.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::pipeline {

// `evidence`: what the gap is shown on (held out); predictions over its whole recording.
report::Page discrepancy_page(const discrepancy::Findings& findings,
                              const std::vector<rendering::Candidate>& candidates,
                              const discrepancy::Evidence& evidence, const rendering::Prediction& before,
                              const rendering::Prediction& after, const surface::TriangleMesh& mesh,
                              const report::Provenance& provenance);

}  // namespace touchstone::pipeline
