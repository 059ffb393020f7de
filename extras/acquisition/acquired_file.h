// Raw streams to a recording in a file, past the gate that every command holds recordings
// against.
#pragma once

#include <filesystem>
#include <string>

#include "acquire.h"

namespace touchstone::acquisition {

struct CheckedAcquisition {
  Acquired acquired;           // its report's notes hold what the gate found, one sentence each
  bool faulty = false;         // the gate found a fault: force reversed or in another frame, another place
  std::filesystem::path file;  // the recording; empty if it was not written

  // Neither faulty nor touched in an interval that should be free air.
  [[nodiscard]] bool passed() const { return !faulty && !acquired.report.contact_in_free_air; }
  [[nodiscard]] std::string text() const;  // for people: each step with its residual, and where the recording is
};

// Acquires, and checks what was made (harness/recording_checks), against the description's mesh if it names one. Throws
// BadData naming file, place, value and what to do.
CheckedAcquisition acquire_and_check(const AcquisitionDescription& description);

// The same, written: the recording to `out` (.csv, .csv.gz or .h5) and the report ("touchstone-acquisition-report/1")
// to `json` unless that is empty. What did not pass is written too: the report's notes say why. Throws BadData also if
// a file cannot be written.
CheckedAcquisition acquire_into(const AcquisitionDescription& description, const std::filesystem::path& out,
                                const std::filesystem::path& json);

}  // namespace touchstone::acquisition
