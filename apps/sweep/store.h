// The results of a sweep: one SQLite file, which Python, R, MATLAB and any SQL shell read. A row of the table `cases`
// is a case that ran or failed; `runs` says which build and machine made which rows. What was committed survives kill
// -9; a case number is the primary key, so that none can count twice.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/sweep/world.h"

namespace touchstone::apps {

struct SweepMerge {
  std::uint64_t added = 0;     // those that stand for a failed one too
  std::uint64_t repeated = 0;  // the same case, with the same result, in more than one part
};

class SweepStore {
 public:
  // Makes the file, or opens that of an earlier run of the same specification. Throws BadData for a file of another
  // sweep, one that is no such file at all (it is left as it is), or one that another process is writing.
  SweepStore(const std::filesystem::path& file, const SweepDesign& design);
  ~SweepStore();
  SweepStore(const SweepStore&) = delete;
  SweepStore& operator=(const SweepStore&) = delete;

  // Who makes the rows from here on: version, commit, compiler, flags, cpu, command, ...
  void start_run(const std::map<std::string, std::string>& provenance);
  // All of them or, where that fails, none.
  void add(std::span<const SweepOutcome> outcomes);

  // Case numbers, ascending.
  [[nodiscard]] std::vector<std::uint64_t> done() const;
  [[nodiscard]] std::uint64_t failed() const;
  // Forgets the rows with an error, so that they run again.
  void forget_failed();
  // Takes the rows of another file of the same sweep. A case that both have must have the same result; where one of the
  // two failed, the other counts. Throws BadData.
  SweepMerge merge(const std::filesystem::path& part);

  // SHA-256 over all rows in the order of their numbers, without who made them: equal where the results are, to the
  // bit.
  [[nodiscard]] std::string content_hash() const;
  // All rows as CSV, in the order of their numbers.
  void write_csv(const std::filesystem::path& file) const;

 private:
  struct Database;
  std::unique_ptr<Database> database_;
};

}  // namespace touchstone::apps
