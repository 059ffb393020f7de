#include "statement.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include "harness/base/error.h"

namespace touchstone::runs {

Statement::Statement(sqlite3* database, const std::string& sql) : database_(database) {
  check(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr));
}
Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(const std::string& text) {
  check(sqlite3_bind_text(statement_, ++at_, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
  return *this;
}
Statement& Statement::bind(std::uint64_t value) {
  check(sqlite3_bind_int64(statement_, ++at_, static_cast<sqlite3_int64>(value)));
  return *this;
}
Statement& Statement::bind(double value) {
  check(sqlite3_bind_double(statement_, ++at_, value));
  return *this;
}
Statement& Statement::bind_null() {
  check(sqlite3_bind_null(statement_, ++at_));
  return *this;
}

bool Statement::step() {
  const int status = sqlite3_step(statement_);
  if (status == SQLITE_ROW) return true;
  if (status != SQLITE_DONE) fail();
  return false;
}

void Statement::run() {
  while (step()) {
  }
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
  at_ = 0;
}

int Statement::columns() const { return sqlite3_column_count(statement_); }
std::string Statement::name(int column) const { return sqlite3_column_name(statement_, column); }

Statement::Type Statement::type(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
    case SQLITE_NULL:
      return Type::null;
    case SQLITE_INTEGER:
      return Type::integer;
    case SQLITE_FLOAT:
      return Type::real;
    default:
      return Type::text;
  }
}

std::uint64_t Statement::number(int column) const {
  return static_cast<std::uint64_t>(sqlite3_column_int64(statement_, column));
}
double Statement::real(int column) const { return sqlite3_column_double(statement_, column); }

std::string Statement::text(int column) const {
  if (type(column) == Type::real) return fmt::format("{}", real(column));
  const auto* const bytes = sqlite3_column_text(statement_, column);
  return bytes == nullptr ? "" : reinterpret_cast<const char*>(bytes);
}

void Statement::check(int status) const {
  if (status != SQLITE_OK) fail();
}

void Statement::fail() const {
  const char* const file = sqlite3_db_filename(database_, "main");
  throw BadData(
      fmt::format("{}: {}", file == nullptr || *file == '\0' ? "database in memory" : file, sqlite3_errmsg(database_)));
}

Database::Database(const std::filesystem::path& file) : file_(file) {
  const int status = sqlite3_open_v2(file.c_str(), &handle_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  if (status != SQLITE_OK) {
    const std::string why = handle_ == nullptr ? "out of memory" : sqlite3_errmsg(handle_);
    sqlite3_close(handle_);
    throw BadData(fmt::format("{}: cannot be opened: {}", file.string(), why));
  }
  sqlite3_busy_timeout(handle_, 2000);
}
Database::~Database() { sqlite3_close(handle_); }

std::uint64_t Database::one_number(const std::string& sql) const {
  Statement statement(handle_, sql);
  return statement.step() ? statement.number(0) : 0;
}

std::string Database::one_text(const std::string& sql) const {
  Statement statement(handle_, sql);
  return statement.step() ? statement.text(0) : "";
}

std::uint64_t Database::changes() const { return static_cast<std::uint64_t>(sqlite3_changes64(handle_)); }

void Database::try_to_run(const char* sql) const noexcept { sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr); }

Transaction::Transaction(const Database& database) : database_(&database) { database.run("BEGIN IMMEDIATE"); }
Transaction::~Transaction() {
  if (open_) database_->try_to_run("ROLLBACK");
}
void Transaction::commit() {
  database_->run("COMMIT");
  open_ = false;
}

std::string quoted_name(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

}  // namespace touchstone::runs
