// The judge (harness/perception/judge) from files to a report: how likely a person tells each condition from the real
// process, and by which channel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/perception/judge/judged_conditions.h"
#include "harness/pipeline/perceiving/request.h"
#include "harness/rendering/catalogue.h"
#include "harness/report/provenance.h"

namespace touchstone::pipeline {

struct JudgedFiles {
  perception::JudgedConditions judged;
  perception::JudgeOptions options;  // those in use
  std::vector<std::string> notes;    // of the recordings and the object, a sentence each
  report::Provenance provenance;

  [[nodiscard]] std::string table() const;                 // for people, the condition hardest to tell first
  [[nodiscard]] std::vector<std::string> remarks() const;  // notes, and what the judge remarked, each once
};

// Shows its progress on a terminal. Throws BadData for files that are faulty or cannot be compared, UsageError for a
// channel or a direction that there is not.
JudgedFiles judge_files(const rendering::Catalogue& catalogue, const PerceiveRequest& request);

// DIR/perception.json and DIR/report.html. Throws BadData if they cannot be written.
void write_judged(const JudgedFiles& files, const std::filesystem::path& folder);

}  // namespace touchstone::pipeline
