// The perception space of Shao, Wu and Ouyang (harness/perception), as published, from files to a report.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "harness/perception/perceptual_evaluation.h"
#include "harness/perception/subjective_comparison.h"
#include "harness/pipeline/perceiving/request.h"
#include "harness/rendering/catalogue.h"
#include "harness/report/provenance.h"

namespace touchstone::pipeline {

struct PaperFiles {
  perception::PerceptualEvaluation evaluation;
  std::optional<perception::SubjectiveComparison> people;  // if people's answers were given
  report::Provenance provenance;

  [[nodiscard]] std::string table() const;  // for people
};

// A process of several measuring parts (eq. 1 and 2) is THUMB.csv+FINGER.csv, in the same order for every process; a
// file whose name has a plus sign is one file. Shows its progress on a terminal. Throws BadData for files that are
// faulty or cannot be compared, UsageError for models beside a process of several parts.
PaperFiles evaluate_by_paper(const rendering::Catalogue& catalogue, const PerceiveRequest& request);

// DIR/perception.json and DIR/report.html. Throws BadData if they cannot be written.
void write_by_paper(const PaperFiles& files, const std::filesystem::path& folder);

}  // namespace touchstone::pipeline
