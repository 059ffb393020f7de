// What an earlier search wrote into the same folder and this one may not write again: pieces of a law, the model with
// it, a motion to record next, a suggested instrument. Left there, they would look like this run's.
#pragma once

#include <filesystem>
#include <vector>

namespace touchstone::pipeline {

class EarlierRun {
 public:
  // Only files that findings.json of the folder names are an earlier run's; without one, or with one that cannot be
  // read, there are none. Throws UsageError where one of them is an input of this run (input_files.h).
  explicit EarlierRun(const std::filesystem::path& folder);
  // Just before this run's files are written. What cannot be removed: BadData with the file and the reason.
  void remove() const;

 private:
  std::vector<std::filesystem::path> files_;
};

}  // namespace touchstone::pipeline
