// What a search has measured, kept line by line as it goes, so that one that was stopped goes on.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace touchstone::bisection {

struct MeasuredCommit {
  std::vector<double> values;
  std::string broken;  // why it could not be measured
};

// One search at a time in a folder. Throws UsageError if another process has it; freed when that ends, however it ends.
class SearchLock {
 public:
  explicit SearchLock(const std::filesystem::path& folder);
  ~SearchLock();
  SearchLock(const SearchLock&) = delete;
  SearchLock& operator=(const SearchLock&) = delete;

 private:
  int descriptor_;
};

class MeasuredTable {
 public:
  // `file`: JSON lines, made if it is not there. Its first line is `about`, what the search is; throws UsageError for a
  // file about another search.
  MeasuredTable(std::filesystem::path file, const std::string& about);

  // For all threads; on the disk when they come back. Throws BadData for a value that is not finite.
  void add(const std::string& commit, double value);
  void add_broken(const std::string& commit, const std::string& why);
  [[nodiscard]] MeasuredCommit find(const std::string& commit) const;
  // Commits that were built, and those of them that are broken.
  [[nodiscard]] std::size_t builds() const;
  [[nodiscard]] std::size_t broken() const;

 private:
  void append(const std::string& line);
  std::filesystem::path file_;
  mutable std::mutex mutex_;
  std::map<std::string, MeasuredCommit> commits_;
};

}  // namespace touchstone::bisection
