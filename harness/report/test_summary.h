// Results of checks for other people's CI: JUnit XML, as GitLab, Jenkins and GitHub's report actions read it (the
// schema of the Jenkins xUnit plug-in, junit-10.xsd; attachments as Jenkins and GitLab take them from system-out), a
// Markdown summary for a job's page ($GITHUB_STEP_SUMMARY), and GitHub's workflow commands, which mark a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::report {

struct CheckedTest {
  std::string group, name;  // "sphere-scan", "god-object"
  bool passed = false;
  double seconds = 0.0;
  std::string verdict;                          // "worse"
  std::string details;                          // for people, several lines
  std::filesystem::path file;                   // that an annotation marks
  std::vector<std::filesystem::path> pictures;  // of a failure
  std::string skipped = {};                     // why it did not run; empty: it ran

  [[nodiscard]] bool failed() const { return !passed && skipped.empty(); }
};

std::string tests_to_junit(const std::string& suite, const std::vector<CheckedTest>& tests);
// A table of what failed first, its details and pictures, by paths relative to `base`.
std::string tests_to_markdown(const std::string& title, const std::vector<CheckedTest>& tests,
                              const std::filesystem::path& base);
// A line `::error file=...,title=...::...` for each failure.
std::string tests_to_github_annotations(const std::vector<CheckedTest>& tests);

}  // namespace touchstone::report
