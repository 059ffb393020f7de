// The report of a search for missing effects, as a page.
#pragma once

#include "harness/base/rooms.h"
#include "harness/discrepancy/findings.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::pipeline {

// `evidence`: what the gap is shown on (held out); predictions over its whole recording.
Page discrepancy_page(const Findings& findings, const std::vector<Candidate>& candidates, const Evidence& evidence,
                      const Prediction& before, const Prediction& after, const TriangleMesh& mesh,
                      const Provenance& provenance);

}  // namespace touchstone::pipeline
