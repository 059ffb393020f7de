#include "apps/sweep/store.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"

namespace touchstone::apps {
namespace {

constexpr int application_id = 0x546f7563;  // "Touc"

// Columns that say what a case gave; those of its design stand before them.
constexpr const char* result_columns =
    "samples INTEGER, contact_samples INTEGER, contact_events INTEGER, peak_force_N REAL, rms_force_N REAL, "
    "mean_fx_N REAL, mean_fy_N REAL, mean_fz_N REAL, contact_path_m REAL, exact_force_rms_N REAL, "
    "exact_force_max_N REAL, exact_contact_rms_m REAL, result_sha256 TEXT, document TEXT";
constexpr int result_column_count = 14;

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql) : database_(database) {
    if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) fail();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(const std::string& text) {
    check(sqlite3_bind_text(statement_, ++at_, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
    return *this;
  }
  Statement& bind(std::uint64_t value) {
    check(sqlite3_bind_int64(statement_, ++at_, static_cast<sqlite3_int64>(value)));
    return *this;
  }
  // SQLite stores NaN as NULL: what a case does not have.
  Statement& bind(double value) {
    check(sqlite3_bind_double(statement_, ++at_, value));
    return *this;
  }
  Statement& bind_null() {
    check(sqlite3_bind_null(statement_, ++at_));
    return *this;
  }
  // False at the end.
  bool step() {
    const int status = sqlite3_step(statement_);
    if (status == SQLITE_ROW) return true;
    if (status != SQLITE_DONE) fail();
    return false;
  }
  void run() {
    while (step()) {
    }
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
    at_ = 0;
  }
  [[nodiscard]] std::uint64_t number(int column) const {
    return static_cast<std::uint64_t>(sqlite3_column_int64(statement_, column));
  }
  [[nodiscard]] int columns() const { return sqlite3_column_count(statement_); }
  [[nodiscard]] std::string name(int column) const { return sqlite3_column_name(statement_, column); }
  // As it reads back to the same value; empty for NULL.
  [[nodiscard]] std::string text(int column) const {
    if (sqlite3_column_type(statement_, column) == SQLITE_FLOAT)
      return fmt::format("{}", sqlite3_column_double(statement_, column));
    const auto* const bytes = sqlite3_column_text(statement_, column);
    return bytes == nullptr ? "" : reinterpret_cast<const char*>(bytes);
  }

 private:
  void check(int status) {
    if (status != SQLITE_OK) fail();
  }
  [[noreturn]] void fail() const {
    throw BadData(fmt::format("{}: {}", sqlite3_db_filename(database_, "main"), sqlite3_errmsg(database_)));
  }
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int at_ = 0;
};

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
}

}  // namespace

struct SweepStore::Database {
  explicit Database(const std::filesystem::path& path) : file(path) {
    const int status = sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    if (status != SQLITE_OK) {
      const std::string why = handle == nullptr ? "out of memory" : sqlite3_errmsg(handle);
      sqlite3_close(handle);
      throw BadData(fmt::format("{}: cannot be opened: {}", path.string(), why));
    }
    sqlite3_busy_timeout(handle, 2000);
  }
  ~Database() { sqlite3_close(handle); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql) const { Statement(handle, sql).run(); }
  [[nodiscard]] std::uint64_t one_number(const std::string& sql) const {
    Statement statement(handle, sql);
    return statement.step() ? statement.number(0) : 0;
  }
  [[nodiscard]] std::string one_text(const std::string& sql) const {
    Statement statement(handle, sql);
    return statement.step() ? statement.text(0) : "";
  }

  void make(const SweepDesign& design) const {
    std::string varied;
    for (const std::string& pointer : design.varied()) varied += quoted(pointer) + " REAL, ";
    run("BEGIN IMMEDIATE");
    run("CREATE TABLE sweep(specification_sha256 TEXT, specification TEXT, cases INTEGER)");
    Statement(handle, "INSERT INTO sweep VALUES(?, ?, ?)")
        .bind(sha256(design.text()))
        .bind(design.text())
        .bind(design.size())
        .run();
    run("CREATE TABLE runs(run INTEGER, name TEXT, value TEXT, PRIMARY KEY(run, name))");
    run("CREATE TABLE cases(case_number INTEGER PRIMARY KEY, run INTEGER, status TEXT, error TEXT, surface TEXT, "
        "trajectory TEXT, model TEXT, seed INTEGER, " +
        varied + result_columns + ")");
    run(fmt::format("PRAGMA application_id = {}", application_id));
    run("COMMIT");
  }

  // Every column but who made the row.
  [[nodiscard]] std::string content_columns() const {
    std::string list;
    Statement columns(handle, "SELECT name FROM pragma_table_info('cases') WHERE name <> 'run' ORDER BY cid");
    while (columns.step()) list += (list.empty() ? "" : ", ") + quoted(columns.text(0));
    return list;
  }

  std::filesystem::path file;
  sqlite3* handle = nullptr;
  std::uint64_t current_run = 0;
};

SweepStore::SweepStore(const std::filesystem::path& file, const SweepDesign& design)
    : database_(std::make_unique<Database>(file)) {
  const auto refuse = [&](const std::string& why) { throw BadData(fmt::format("{}: {}", file.string(), why)); };
  // Held to the end: two processes that fill one file would do the same cases.
  database_->run("PRAGMA locking_mode = EXCLUSIVE");
  try {
    database_->run("BEGIN IMMEDIATE");
    database_->run("COMMIT");
  } catch (const BadData& error) {
    refuse(std::string(error.what()).find("locked") != std::string::npos
               ? "another process is writing it; wait for that, or give another --out"
               : "is not the result file of a sweep; it is left as it is");
  }
  const bool empty = database_->one_number("SELECT count(*) FROM sqlite_master") == 0;
  if (empty) database_->make(design);
  if (database_->one_number("PRAGMA application_id") != application_id)
    refuse("is a database, but not the result file of a sweep; it is left as it is");
  if (database_->one_text("SELECT specification_sha256 FROM sweep") != sha256(design.text()))
    refuse("holds the results of another specification; give another --out, or remove it");
}

SweepStore::~SweepStore() = default;

void SweepStore::start_run(const std::map<std::string, std::string>& provenance) {
  database_->current_run = database_->one_number("SELECT coalesce(max(run), 0) + 1 FROM runs");
  database_->run("BEGIN IMMEDIATE");
  Statement insert(database_->handle, "INSERT INTO runs VALUES(?, ?, ?)");
  for (const auto& [name, value] : provenance) insert.bind(database_->current_run).bind(name).bind(value).run();
  database_->run("COMMIT");
}

void SweepStore::add(std::span<const SweepOutcome> outcomes) {
  if (outcomes.empty()) return;
  constexpr int before = 8;
  const auto varied = database_->one_number("SELECT count(*) FROM pragma_table_info('cases')") - before -
                      static_cast<std::uint64_t>(result_column_count);
  std::string marks = "?";
  for (std::uint64_t i = 1; i < before + varied + static_cast<std::uint64_t>(result_column_count); ++i) marks += ", ?";
  Statement insert(database_->handle, fmt::format("INSERT INTO cases VALUES({})", marks));
  database_->run("BEGIN IMMEDIATE");
  try {
    for (const SweepOutcome& outcome : outcomes) {
      const SweepCase& one = outcome.one;
      const bool ran = outcome.error.empty();
      insert.bind(one.number).bind(database_->current_run).bind(std::string(ran ? "ran" : "failed"));
      ran ? insert.bind_null() : insert.bind(outcome.error);
      insert.bind(one.surface).bind(one.trajectory).bind(one.model);
      one.seed ? insert.bind(*one.seed) : insert.bind_null();
      for (std::uint64_t a = 0; a < varied; ++a) insert.bind(a < one.varied.size() ? one.varied[a] : std::nan(""));
      const GoldenSummary& s = outcome.summary;
      if (ran) {
        insert.bind(std::uint64_t{s.samples})
            .bind(std::uint64_t{s.contact_samples})
            .bind(std::uint64_t{s.contact_events});
        insert.bind(s.peak_force_N).bind(s.rms_force_N);
        for (int axis = 0; axis < 3; ++axis) insert.bind(s.mean_force_W_N[axis]);
        insert.bind(s.contact_path_m);
      } else {
        constexpr int summary_columns = 9;
        for (int i = 0; i < summary_columns; ++i) insert.bind_null();
      }
      const double none = std::nan("");
      insert.bind(outcome.exact ? outcome.exact->force_rms_N : none);
      insert.bind(outcome.exact ? outcome.exact->force_max_N : none);
      insert.bind(outcome.exact ? outcome.exact->contact_rms_m : none);
      ran ? insert.bind(s.sha256) : insert.bind_null();
      insert.bind(one.document).run();
    }
    database_->run("COMMIT");
  } catch (...) {
    sqlite3_exec(database_->handle, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::vector<std::uint64_t> SweepStore::done() const {
  std::vector<std::uint64_t> numbers;
  Statement select(database_->handle, "SELECT case_number FROM cases ORDER BY case_number");
  while (select.step()) numbers.push_back(select.number(0));
  return numbers;
}

std::uint64_t SweepStore::failed() const {
  return database_->one_number("SELECT count(*) FROM cases WHERE status = 'failed'");
}

void SweepStore::forget_failed() { database_->run("DELETE FROM cases WHERE status = 'failed'"); }

SweepMerge SweepStore::merge(const std::filesystem::path& part) {
  if (!std::filesystem::exists(part)) throw BadData(fmt::format("{}: does not exist", part.string()));
  Statement(database_->handle, "ATTACH DATABASE ? AS part").bind(part.string()).run();
  const auto detach = [&](Database* d) { sqlite3_exec(d->handle, "DETACH DATABASE part", nullptr, nullptr, nullptr); };
  const std::unique_ptr<Database, decltype(detach)> detached(database_.get(), detach);
  try {
    if (database_->one_text("SELECT specification_sha256 FROM part.sweep") !=
        database_->one_text("SELECT specification_sha256 FROM main.sweep"))
      throw BadData("it holds the results of another specification");
  } catch (const BadData& error) {
    throw BadData(fmt::format("{}: is no part of this sweep: {}", part.string(), error.what()));
  }
  // `IS` and not `=`: absent equals absent.
  const std::string columns = database_->content_columns();
  std::string differs;
  for (std::size_t at = 0; at < columns.size();) {
    const auto end = std::min(columns.find(", ", at), columns.size());
    const std::string column = columns.substr(at, end - at);
    differs += fmt::format("{}a.{} IS NOT b.{}", differs.empty() ? "" : " OR ", column, column);
    at = end + 2;
  }
  const std::string both = "main.cases a JOIN part.cases b ON a.case_number = b.case_number";
  const std::string clash = database_->one_text(fmt::format(
      "SELECT a.case_number FROM {} WHERE a.status = 'ran' AND b.status = 'ran' AND ({}) LIMIT 1", both, differs));
  if (!clash.empty())
    throw BadData(fmt::format("{}: case {} has another result than in {}; were they made by different builds?",
                              part.string(), clash, database_->file.string()));
  SweepMerge merged;
  merged.repeated = database_->one_number("SELECT count(*) FROM " + both);
  const std::string offset = database_->one_text("SELECT coalesce(max(run), 0) FROM main.runs");
  database_->run("BEGIN IMMEDIATE");
  try {
    database_->run(
        "DELETE FROM main.cases WHERE status = 'failed' AND case_number IN (SELECT case_number FROM part.cases "
        "WHERE status = 'ran')");
    database_->run(fmt::format("INSERT INTO main.runs SELECT run + {}, name, value FROM part.runs", offset));
    database_->run(
        fmt::format("INSERT INTO main.cases(run, {0}) SELECT run + {1}, {0} FROM part.cases WHERE case_number "
                    "NOT IN (SELECT case_number FROM main.cases)",
                    columns, offset));
    merged.added = static_cast<std::uint64_t>(sqlite3_changes64(database_->handle));
    database_->run("COMMIT");
  } catch (...) {
    sqlite3_exec(database_->handle, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
  return merged;
}

std::string SweepStore::content_hash() const {
  Statement select(database_->handle,
                   fmt::format("SELECT {} FROM cases ORDER BY case_number", database_->content_columns()));
  std::string chain;
  while (select.step()) {
    std::string row = chain;
    for (int c = 0; c < select.columns(); ++c) row += '\x1f' + select.text(c);
    chain = sha256(row);
  }
  return chain;
}

void SweepStore::write_csv(const std::filesystem::path& file) const {
  Statement select(database_->handle, "SELECT * FROM cases ORDER BY case_number");
  std::string text;
  for (int c = 0; c < select.columns(); ++c) text += (c == 0 ? "" : ",") + csv_field(select.name(c));
  text += '\n';
  while (select.step()) {
    for (int c = 0; c < select.columns(); ++c) text += (c == 0 ? "" : ",") + csv_field(select.text(c));
    text += '\n';
  }
  write_file(file, text);
}

}  // namespace touchstone::apps
