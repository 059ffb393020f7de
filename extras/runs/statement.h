// An SQLite database and its statements, with errors as BadData that name the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace touchstone::runs {

class Statement {
 public:
  // Throws BadData, as everything here does, for SQL that is wrong or a database that cannot be read or written.
  Statement(sqlite3* database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // The next parameter. SQLite stores NaN as NULL.
  Statement& bind(const std::string& text);
  Statement& bind(std::uint64_t value);
  Statement& bind(double value);
  Statement& bind_null();
  // To the next row; false at the end.
  bool step();
  // Through all rows; ready to be bound again.
  void run();

  enum class Type { null, integer, real, text };
  [[nodiscard]] int columns() const;
  [[nodiscard]] std::string name(int column) const;
  [[nodiscard]] Type type(int column) const;
  [[nodiscard]] std::uint64_t number(int column) const;
  [[nodiscard]] double real(int column) const;
  // As it reads back to the same value; empty for NULL.
  [[nodiscard]] std::string text(int column) const;

 private:
  void check(int status) const;
  [[noreturn]] void fail() const;
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int at_ = 0;
};

class Database {
 public:
  static constexpr const char* in_memory = ":memory:";

  explicit Database(const std::filesystem::path& file);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  [[nodiscard]] sqlite3* handle() const noexcept { return handle_; }
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  void run(const std::string& sql) const { Statement(handle_, sql).run(); }
  // Of the first row's first column; 0 or "" where there is none.
  [[nodiscard]] std::uint64_t one_number(const std::string& sql) const;
  [[nodiscard]] std::string one_text(const std::string& sql) const;
  // Rows that the last statement changed.
  [[nodiscard]] std::uint64_t changes() const;
  // Without throwing: for ends.
  void try_to_run(const char* sql) const noexcept;

 private:
  std::filesystem::path file_;
  sqlite3* handle_ = nullptr;
};

// All that is done before commit(), or nothing.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database* database_;
  bool open_ = true;
};

// A name as SQL takes it, whatever is in it.
std::string quoted_name(const std::string& name);

}  // namespace touchstone::runs
