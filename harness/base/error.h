// Errors that a user can act on: what kind, where, and what to do. The kind decides the exit status of the program.
#pragma once

#include <stdexcept>
#include <string>

namespace touchstone {

// Exit status of `touchstone`: names and numbers are relied on by outside programs.
enum class ExitStatus : int { passed = 0, failed = 1, usage = 2, bad_data = 3, skipped = 77 };

// Base of every error that Touchstone throws on purpose. what() is one readable paragraph.
class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  [[nodiscard]] ExitStatus status() const noexcept { return status_; }

 private:
  ExitStatus status_;
};

// A file or value that cannot be used: names file, line or column, value, what was expected and what to do.
class BadData : public Error {
 public:
  explicit BadData(const std::string& message) : Error(ExitStatus::bad_data, message) {}
};

// The command line or an argument of a call makes no sense.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitStatus::usage, message) {}
};

}  // namespace touchstone
