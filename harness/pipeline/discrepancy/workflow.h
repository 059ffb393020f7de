// The search for missing effects from files to files: what `touchstone discrepancy` runs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "harness/discrepancy/findings.h"
#include "harness/pipeline/discrepancy/inputs.h"

namespace touchstone::pipeline {

// Every contact effect and instrument entry of the catalogue.
std::vector<rendering::Candidate> all_candidates(const rendering::Catalogue& catalogue);
// The same and the effects that these files declare. Throws BadData for a file that is wrong or has a name twice.
std::vector<rendering::Candidate> all_candidates(const rendering::Catalogue& catalogue,
                                                 const std::vector<std::filesystem::path>& effects);

// Searches and writes report.html, findings.json, model.json and, where another recording would tell, next.csv.
// Throws BadData and UsageError. `report` gets a line at every step.
discrepancy::Findings run_discrepancy(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files,
                                      const std::function<void(const std::string&)>& report);

// What a user reads on the console.
std::string findings_text(const discrepancy::Findings& findings, const DiscrepancyFiles& files);

}  // namespace touchstone::pipeline
