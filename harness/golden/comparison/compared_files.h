// Two files of columns held against each other (harness/golden/comparison/compare.h), with what explains a failure: the
// floor that a repeat of the motion gives, and faults of the file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/golden/comparison/compare.h"
#include "harness/golden/comparison/tolerance.h"
#include "harness/recording_checks/repeat_floor.h"

namespace touchstone::golden {

struct CompareRequest {
  std::filesystem::path expected, obtained;
  std::filesystem::path repeat;        // of the motion of `expected`; empty: none
  std::optional<Tolerance> tolerance;  // none: default_tolerance(), and errors within the floor of a repeat pass
  bool flip_force = false;             // `obtained` has the force BY the probe
};

struct ComparedFiles {
  TrajectoryColumns expected, obtained;
  Comparison comparison;
  std::optional<recording_checks::RepeatFloor> floor;  // if there is a repeat
  bool within_floor = false;  // no error is larger than what the real thing has from one time to the next
  bool passed = false;

  // Faults of the file that explain why it differs, each with its repair; empty if it passed or cannot be compared.
  [[nodiscard]] std::vector<std::string> explanations() const;
  // The comparison for people, with the floor.
  [[nodiscard]] std::string text() const;
  // The comparison with "repeat_floor", if there is one.
  [[nodiscard]] std::string json() const;
  // One number of it (force_rms_N). Throws BadData that lists those that there are.
  [[nodiscard]] double metric(const std::string& name) const;
};

// Throws BadData for a file that cannot be read, and for a repeat that does not repeat.
ComparedFiles compare_files(const CompareRequest& request);

// Place, force and orientation of the columns. Empty if place or force is missing or has other rows than the others;
// without orientation if that is not there or has other rows.
recording::Recording recording_of(const TrajectoryColumns& columns);

}  // namespace touchstone::golden
