// The results of many cases: one SQLite file, which Python, R, MATLAB and any SQL shell read. A row of the table
// `cases` is a case that ran or failed; `runs` says which build and machine made which rows; `sweep` holds the
// specification. What was committed survives kill -9; a case number is the primary key, so that none can count twice.
// What a case is, only its columns say.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace touchstone::runs {

struct CaseColumn {
  enum class Type { text, integer, real };
  std::string name;
  Type type = Type::real;
  // A time or the like, which is another in each run: no part of what a merge compares and the hash covers.
  bool varies = false;
  // A hash of numbers to the bit: another wherever one of them is; no part of a comparison within a tolerance.
  bool of_bits = false;
};

// What a file is about.
struct CaseTable {
  std::string specification;  // canonical: equal text, equal results; its SHA-256 names the file
  std::uint64_t cases = 0;
  std::vector<CaseColumn> columns;
  std::string what = "specification";  // "holds the results of another {what}"
  std::string file_option = "--out";   // with which the user names the file
};

// Absent where a case has none; NaN is kept as absent.
using CaseValue = std::variant<std::monostate, std::uint64_t, double, std::string>;
// NaN for an absent one; an integer as a double. Throws BadData for text.
double as_number(const CaseValue& value);
// Throws BadData for what is no text, no integer.
const std::string& as_text(const CaseValue& value);
std::uint64_t as_integer(const CaseValue& value);

struct CaseRow {
  std::uint64_t number = 0;
  std::string error;              // empty: it ran
  std::vector<CaseValue> values;  // by column; those that are not there are absent
};

struct CaseMerge {
  std::uint64_t added = 0;     // those that stand for a failed one too
  std::uint64_t repeated = 0;  // the same case, with the same result, in more than one part
};

class CaseStore {
 public:
  // A file that ends with the program.
  static constexpr const char* in_memory = ":memory:";

  // Makes the file, or opens that of an earlier run of the same specification. Throws BadData for a file of another
  // one, one that is no such file at all (it is left as it is), one that another process is writing, or one with a row
  // that was changed after it was stored.
  CaseStore(const std::filesystem::path& file, const CaseTable& table);
  // An exception takes a file with it that this object made and that has no row.
  ~CaseStore();
  CaseStore(const CaseStore&) = delete;
  CaseStore& operator=(const CaseStore&) = delete;

  // Who makes the rows from here on: version, commit, compiler, flags, cpu, command, ...
  void start_run(const std::map<std::string, std::string>& provenance);
  // Who made the rows that are there: the values of `names` in every run of which there are rows, each once.
  [[nodiscard]] std::set<std::string> makers(const std::vector<std::string>& names) const;
  // All of them or, where that fails, none. Each with a check sum over its content and the specification.
  void add(std::span<const CaseRow> rows);

  // Case numbers, ascending.
  [[nodiscard]] std::vector<std::uint64_t> done() const;
  [[nodiscard]] std::uint64_t failed() const;
  // Rows as they were added, ascending, of the numbers from `first` to before `last`.
  [[nodiscard]] std::vector<CaseRow> rows(std::uint64_t first, std::uint64_t last) const;
  // Forgets the rows with an error, so that they run again.
  void forget_failed();
  // Takes the rows of another file of the same specification. A case that both have must have the same result; where
  // one of the two failed, the other counts. Throws BadData, for a row of the part that was changed, too.
  // `relative`: numbers may differ by this share of the larger one, as those of another processor or compiler do; 0: to
  // the bit.
  CaseMerge merge(const std::filesystem::path& part, double relative = 0.0);

  // SHA-256 over all rows in the order of their numbers, without who made them: equal where the results are, to the
  // bit.
  [[nodiscard]] std::string content_hash() const;
  // All rows as CSV, in the order of their numbers.
  void write_csv(const std::filesystem::path& file) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::runs
