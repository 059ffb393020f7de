#include "case_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <stdexcept>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "statement.h"

namespace touchstone::runs {
namespace {

constexpr int application_id = 0x546f7563;  // "Touc"
constexpr std::size_t longest_shown = 1000;

const char* sql_type(CaseColumn::Type type) {
  switch (type) {
    case CaseColumn::Type::text:
      return "TEXT";
    case CaseColumn::Type::integer:
      return "INTEGER";
    default:
      return "REAL";
  }
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
}

void bind_value(Statement& statement, const CaseValue& value) {
  if (const auto* const integer = std::get_if<std::uint64_t>(&value)) {
    statement.bind(*integer);
  } else if (const auto* const real = std::get_if<double>(&value)) {
    statement.bind(*real);
  } else if (const auto* const text = std::get_if<std::string>(&value)) {
    statement.bind(*text);
  } else {
    statement.bind_null();
  }
}

CaseValue value_of(const Statement& row, int column) {
  switch (row.type(column)) {
    case Statement::Type::integer:
      return row.number(column);
    case Statement::Type::real:
      return row.real(column);
    case Statement::Type::text:
      return row.text(column);
    default:
      return {};
  }
}

}  // namespace

double as_number(const CaseValue& value) {
  if (const auto* const real = std::get_if<double>(&value)) return *real;
  if (const auto* const integer = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*integer);
  if (const auto* const text = std::get_if<std::string>(&value))
    throw BadData(fmt::format("a stored case has the text '{}' where a number was expected", *text));
  return std::numeric_limits<double>::quiet_NaN();
}

const std::string& as_text(const CaseValue& value) {
  if (const auto* const text = std::get_if<std::string>(&value)) return *text;
  throw BadData("a stored case has no text where one was expected");
}

std::uint64_t as_integer(const CaseValue& value) {
  if (const auto* const integer = std::get_if<std::uint64_t>(&value)) return *integer;
  throw BadData("a stored case has no whole number where one was expected");
}

struct CaseStore::State {
  State(const std::filesystem::path& file, const CaseTable& wanted) : database(file), table(wanted) {}

  void make() const {
    std::string columns;
    for (const CaseColumn& column : table.columns)
      columns += fmt::format(", {} {}", quoted_name(column.name), sql_type(column.type));
    Transaction all(database);
    database.run("CREATE TABLE sweep(specification_sha256 TEXT, specification TEXT, cases INTEGER)");
    Statement(database.handle(), "INSERT INTO sweep VALUES(?, ?, ?)")
        .bind(sha256(table.specification))
        .bind(table.specification)
        .bind(table.cases)
        .run();
    database.run("CREATE TABLE runs(run INTEGER, name TEXT, value TEXT, PRIMARY KEY(run, name))");
    database.run(
        "CREATE TABLE cases(case_number INTEGER PRIMARY KEY, run INTEGER, status TEXT, error TEXT, row_check TEXT" +
        columns + ")");
    database.run(fmt::format("PRAGMA application_id = {}", application_id));
    all.commit();
  }

  // Every column but who made the row; `varying`: those that are another in each run, too.
  [[nodiscard]] std::vector<std::string> columns(bool varying) const {
    std::vector<std::string> names{"\"case_number\"", "\"status\"", "\"error\""};
    for (const CaseColumn& column : table.columns) {
      if (varying || !column.varies) names.push_back(quoted_name(column.name));
    }
    return names;
  }

  // Over everything of the row of `select`, whose columns are columns(true), and the specification. It finds damage and
  // rows that were edited or brought from elsewhere by mistake; it is no signature.
  [[nodiscard]] std::string check_of(const Statement& select) const {
    std::string text = specification_sha256;
    for (int c = 0; c < select.columns(); ++c) {
      const bool absent = select.type(c) == Statement::Type::null;
      text += (absent ? "\x1e" : "\x1f") + select.text(c);
    }
    return sha256(text).substr(0, 16);
  }

  // The first row of `cases` ("main.cases") that is not as it was stored; empty when all are.
  [[nodiscard]] std::string changed_row(const std::string& cases) const {
    const std::string names = fmt::format("{}", fmt::join(columns(true), ", "));
    Statement select(database.handle(), fmt::format("SELECT {} FROM {} ORDER BY case_number", names, cases));
    Statement checks(database.handle(), fmt::format("SELECT row_check FROM {} ORDER BY case_number", cases));
    while (select.step()) {
      if (!checks.step() || checks.text(0) != check_of(select)) return select.text(0);
    }
    return "";
  }

  Database database;
  CaseTable table;
  std::string specification_sha256 = sha256(table.specification);
  std::uint64_t current_run = 0;
  bool made = false;  // the file, by this object
};

namespace {

constexpr int first_value_column = 5;  // of the table `cases`, after case_number, run, status, error, row_check

std::string changed_row_message(const std::string& file, const std::string& number) {
  return fmt::format(
      "{}: case {} is not as it was stored: it was edited, damaged, or brought from another file. Remove the row "
      "(DELETE "
      "FROM cases WHERE case_number = {}) and run again",
      file, number, number);
}

}  // namespace

CaseStore::CaseStore(const std::filesystem::path& file, const CaseTable& table)
    : state_(std::make_unique<State>(file, table)) {
  const Database& database = state_->database;
  const auto refuse = [&](const std::string& why) { throw BadData(fmt::format("{}: {}", file.string(), why)); };
  // Held to the end: two processes that fill one file would do the same cases.
  database.run("PRAGMA locking_mode = EXCLUSIVE");
  try {
    Transaction(database).commit();
  } catch (const BadData& error) {
    refuse(std::string(error.what()).find("locked") != std::string::npos
               ? fmt::format("another process is writing it; wait for that, or give another {}", table.file_option)
               : "is no file of results; it is left as it is");
  }
  state_->made = database.one_number("SELECT count(*) FROM sqlite_master") == 0;
  if (state_->made) state_->make();
  if (database.one_number("PRAGMA application_id") != application_id)
    refuse("is a database, but no file of results; it is left as it is");
  if (database.one_text("SELECT specification_sha256 FROM sweep") != sha256(table.specification)) {
    const std::string theirs = database.one_text("SELECT specification FROM sweep");
    const bool shown = theirs.size() + table.specification.size() <= longest_shown;
    refuse(fmt::format("holds the results of another {}; give another {}, or remove it{}", table.what,
                       table.file_option,
                       shown ? fmt::format("\n  it holds: {}\n  wanted:   {}", theirs, table.specification) : ""));
  }
  std::vector<std::string> there;
  Statement columns(database.handle(), "SELECT name FROM pragma_table_info('cases') WHERE cid > 3 ORDER BY cid");
  while (columns.step()) there.push_back(columns.text(0));
  std::vector<std::string> expected{"row_check"};
  for (const CaseColumn& column : table.columns) expected.push_back(column.name);
  if (there != expected)
    refuse(fmt::format("was made by another version, with other columns; give another {}, or remove it",
                       table.file_option));
  if (const std::string changed = state_->changed_row("main.cases"); !changed.empty())
    throw BadData(changed_row_message(file.string(), changed));
  Statement(database.handle(), "UPDATE sweep SET cases = ? WHERE cases < ?1").bind(table.cases).run();
}

CaseStore::~CaseStore() {
  const bool nothing =
      state_->made && std::uncaught_exceptions() > 0 && state_->database.one_number("SELECT count(*) FROM cases") == 0;
  const std::filesystem::path file = state_->database.file();
  state_.reset();
  std::error_code ignored;
  if (nothing) std::filesystem::remove(file, ignored);
}

void CaseStore::start_run(const std::map<std::string, std::string>& provenance) {
  const Database& database = state_->database;
  state_->current_run = database.one_number("SELECT coalesce(max(run), 0) + 1 FROM runs");
  Transaction all(database);
  Statement insert(database.handle(), "INSERT INTO runs VALUES(?, ?, ?)");
  for (const auto& [name, value] : provenance) insert.bind(state_->current_run).bind(name).bind(value).run();
  all.commit();
}

std::set<std::string> CaseStore::makers(const std::vector<std::string>& names) const {
  Statement runs(state_->database.handle(), "SELECT DISTINCT run FROM cases");
  Statement value(state_->database.handle(), "SELECT coalesce(max(value), '') FROM runs WHERE run = ? AND name = ?");
  std::set<std::string> makers;
  while (runs.step()) {
    std::string text;
    for (const std::string& name : names) {
      value.bind(runs.number(0)).bind(name).step();
      text += (text.empty() ? "" : ", ") + name + " " + value.text(0);
      value.run();
    }
    makers.insert(std::move(text));
  }
  return makers;
}

void CaseStore::add(std::span<const CaseRow> rows) {
  if (rows.empty()) return;
  const std::size_t columns = state_->table.columns.size();
  std::string marks = "?, ?, ?, ?, NULL";
  for (std::size_t i = 0; i < columns; ++i) marks += ", ?";
  Transaction all(state_->database);
  Statement insert(state_->database.handle(), fmt::format("INSERT INTO cases VALUES({})", marks));
  for (const CaseRow& row : rows) {
    if (row.values.size() > columns) throw std::logic_error("a case has more values than columns");
    const bool ran = row.error.empty();
    insert.bind(row.number).bind(state_->current_run).bind(std::string(ran ? "ran" : "failed"));
    ran ? insert.bind_null() : insert.bind(row.error);
    for (std::size_t c = 0; c < columns; ++c) bind_value(insert, c < row.values.size() ? row.values[c] : CaseValue());
    insert.run();
  }
  // The check covers what the database made of the values.
  Statement stored(state_->database.handle(),
                   fmt::format("SELECT {} FROM cases WHERE case_number = ?", fmt::join(state_->columns(true), ", ")));
  Statement check(state_->database.handle(), "UPDATE cases SET row_check = ? WHERE case_number = ?");
  for (const CaseRow& row : rows) {
    stored.bind(row.number).step();
    check.bind(state_->check_of(stored)).bind(row.number).run();
    stored.run();
  }
  all.commit();
}

std::vector<std::uint64_t> CaseStore::done() const {
  std::vector<std::uint64_t> numbers;
  Statement select(state_->database.handle(), "SELECT case_number FROM cases ORDER BY case_number");
  while (select.step()) numbers.push_back(select.number(0));
  return numbers;
}

std::uint64_t CaseStore::failed() const {
  return state_->database.one_number("SELECT count(*) FROM cases WHERE status = 'failed'");
}

std::vector<CaseRow> CaseStore::rows(std::uint64_t first, std::uint64_t last) const {
  Statement select(state_->database.handle(),
                   "SELECT * FROM cases WHERE case_number >= ? AND case_number < ? ORDER BY case_number");
  select.bind(first).bind(last);
  constexpr int error_column = 3;
  std::vector<CaseRow> rows;
  while (select.step()) {
    CaseRow row{select.number(0), select.text(error_column), {}};
    for (int c = first_value_column; c < select.columns(); ++c) row.values.push_back(value_of(select, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

void CaseStore::forget_failed() { state_->database.run("DELETE FROM cases WHERE status = 'failed'"); }

CaseMerge CaseStore::merge(const std::filesystem::path& part, double relative) {
  const Database& database = state_->database;
  if (!std::filesystem::exists(part)) throw BadData(fmt::format("{}: does not exist", part.string()));
  Statement(database.handle(), "ATTACH DATABASE ? AS part").bind(part.string()).run();
  const auto detach = [](const Database* d) { d->try_to_run("DETACH DATABASE part"); };
  const std::unique_ptr<const Database, decltype(detach)> detached(&database, detach);
  try {
    if (database.one_text("SELECT specification_sha256 FROM part.sweep") !=
        database.one_text("SELECT specification_sha256 FROM main.sweep"))
      throw BadData(fmt::format("it holds the results of another {}", state_->table.what));
  } catch (const BadData& error) {
    throw BadData(fmt::format("{}: is no part of this sweep: {}", part.string(), error.what()));
  }
  if (const std::string changed = state_->changed_row("part.cases"); !changed.empty())
    throw BadData(changed_row_message(part.string(), changed));
  // `IS` and not `=`: absent equals absent.
  std::string differs = "a.status IS NOT b.status OR a.error IS NOT b.error";
  for (const CaseColumn& column : state_->table.columns) {
    if (column.varies || (column.of_bits && relative > 0.0)) continue;
    const std::string name = quoted_name(column.name);
    if (column.type == CaseColumn::Type::real && relative > 0.0) {
      differs += fmt::format(
          " OR (a.{0} IS NULL) IS NOT (b.{0} IS NULL) OR (a.{0} > 1.7e308) IS NOT (b.{0} > 1.7e308) OR "
          "(a.{0} < -1.7e308) IS NOT (b.{0} < -1.7e308) OR "
          "abs(a.{0} - b.{0}) > {1:.17g} * max(abs(a.{0}), abs(b.{0}))",
          name, relative);
    } else {
      differs += fmt::format(" OR a.{0} IS NOT b.{0}", name);
    }
  }
  const std::string both = "main.cases a JOIN part.cases b ON a.case_number = b.case_number";
  const std::string clash = database.one_text(fmt::format(
      "SELECT a.case_number FROM {} WHERE a.status = 'ran' AND b.status = 'ran' AND ({}) LIMIT 1", both, differs));
  if (!clash.empty()) {
    const auto processor = [&](const std::string& file) {
      const std::string cpu = database.one_text(
          fmt::format("SELECT coalesce((SELECT r.value FROM {0}.cases c JOIN {0}.runs r ON r.run = c.run "
                      "WHERE c.case_number = {1} AND r.name = 'cpu'), 'an unknown processor')",
                      file, clash));
      return cpu;
    };
    throw BadData(fmt::format(
        "{}: case {} has another result than in {}; were they made by different builds? Made on {} and on {}; "
        "--merge-tolerance R takes numbers that differ by less than R of the larger",
        part.string(), clash, database.file().string(), processor("part"), processor("main")));
  }
  CaseMerge merged;
  merged.repeated = database.one_number("SELECT count(*) FROM " + both);
  const std::string offset = database.one_text("SELECT coalesce(max(run), 0) FROM main.runs");
  Transaction all(database);
  database.run(
      "DELETE FROM main.cases WHERE status = 'failed' AND case_number IN (SELECT case_number FROM part.cases "
      "WHERE status = 'ran')");
  database.run(fmt::format("INSERT INTO main.runs SELECT run + {}, name, value FROM part.runs", offset));
  database.run(fmt::format(
      "INSERT INTO main.cases(run, row_check, {0}) SELECT run + {1}, row_check, {0} FROM part.cases WHERE case_number "
      "NOT IN (SELECT case_number FROM main.cases)",
      fmt::join(state_->columns(true), ", "), offset));
  merged.added = database.changes();
  all.commit();
  return merged;
}

std::string CaseStore::content_hash() const {
  Statement select(state_->database.handle(),
                   fmt::format("SELECT {} FROM cases ORDER BY case_number", fmt::join(state_->columns(false), ", ")));
  std::string chain;
  while (select.step()) {
    std::string row = chain;
    for (int c = 0; c < select.columns(); ++c) row += '\x1f' + select.text(c);
    chain = sha256(row);
  }
  return chain;
}

void CaseStore::write_csv(const std::filesystem::path& file) const {
  std::string columns = "case_number, run, status, error";
  for (const CaseColumn& column : state_->table.columns) columns += ", " + quoted_name(column.name);
  Statement select(state_->database.handle(), fmt::format("SELECT {} FROM cases ORDER BY case_number", columns));
  std::string text;
  for (int c = 0; c < select.columns(); ++c) text += (c == 0 ? "" : ",") + csv_field(select.name(c));
  text += '\n';
  while (select.step()) {
    for (int c = 0; c < select.columns(); ++c) text += (c == 0 ? "" : ",") + csv_field(select.text(c));
    text += '\n';
  }
  write_file(file, text);
}

}  // namespace touchstone::runs
