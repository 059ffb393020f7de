// The search for missing effects from files to files: what `touchstone discrepancy` runs.
//
//   touchstone::pipeline::DiscrepancyFiles files;
//   files.model = "model.json", files.mesh = "object.obj", files.recording = "train.csv", files.out = "found";
//   const auto answer = run_discrepancy(touchstone::renderers::built_in_catalogue(), files, [](const std::string&) {});
//   if (answer.verdict == touchstone::discrepancy::FindingsVerdict::explained)
//   std::puts(answer.effects.front().c_str());
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/discrepancy/findings_verdict.h"
#include "harness/pipeline/discrepancy/request.h"
#include "harness/rendering/catalogue.h"

namespace touchstone::pipeline {

struct DiscrepancyAnswer {
  discrepancy::FindingsVerdict verdict = discrepancy::FindingsVerdict::consistent;
  std::vector<std::string> effects;  // named, the first to be found first
  std::string text;                  // for a person
};

// Searches and writes report.html, findings.json ("touchstone-findings/1": all that was found), model.json and, where
// another recording would tell, next.csv. Throws BadData and UsageError. `report` gets a line at every step.
DiscrepancyAnswer run_discrepancy(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files,
                                  const std::function<void(const std::string&)>& report);

}  // namespace touchstone::pipeline
