// The search for missing effects from files to files: what `touchstone discrepancy` and `touchstone blind run` share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/discrepancy/inputs.h"
#include "harness/base/rooms.h"
#include "harness/discrepancy/findings.h"

namespace touchstone::apps {

// Every effect of the catalogues.
std::vector<Candidate> all_candidates();

// Searches and writes report.html, findings.json, model.json and, where another recording would tell, next.csv.
// Throws BadData and UsageError. `report` gets a line at every step.
Findings run_discrepancy(const DiscrepancyFiles& files, const std::function<void(const std::string&)>& report);

// What a user reads on the console.
std::string findings_text(const Findings& findings, const DiscrepancyFiles& files);

}  // namespace touchstone::apps
