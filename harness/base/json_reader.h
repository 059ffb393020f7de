// Reading JSON files that people write: every error names the file and the place in it (a JSON pointer such as
// /effects/0/parameters) with its line, and a key that nothing reads is an error, so that a misspelt name cannot be
// ignored silently.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone {

// The parsed file; throws BadData with line and column for malformed text. Duplicate keys are refused.
nlohmann::json load_json(const std::filesystem::path& path);
nlohmann::json parse_json(std::string_view text, std::string_view source);

// " (line 3)", of the key or element at a place such as /effects/0; "" where that cannot be said. A source is the
// file's name, or that of a document within it: "case.json: /models/steel".
std::string line_in_file(const std::string& source, const std::string& place);

// One object of a JSON document while it is read. Call finish() when done: it refuses keys that were not asked for.
// Keeps references to the document: the document must outlive it.
class JsonObject {
 public:
  // `source` is the file's name for messages, `place` the JSON pointer of this object ("" for the root).
  JsonObject(const nlohmann::json& value, std::string source, std::string place);

  [[nodiscard]] bool has(std::string_view key) const;
  // The required ones throw BadData when the key is absent or of another type; numbers must be finite.
  double number(std::string_view key);
  std::string text(std::string_view key);
  JsonObject object(std::string_view key);
  std::vector<JsonObject> objects(std::string_view key);
  std::vector<double> numbers(std::string_view key);
  std::optional<double> optional_number(std::string_view key);
  std::optional<std::string> optional_text(std::string_view key);
  std::optional<bool> optional_flag(std::string_view key);
  // The raw value, marked as read; throws BadData when the key is absent.
  const nlohmann::json& raw(std::string_view key);
  // All keys in the file's order of sorting, for objects whose keys are data (parameters); does not mark them read.
  [[nodiscard]] std::vector<std::string> keys() const;
  // The object as JSON, for readers of text.
  [[nodiscard]] std::string text_of_all() const;
  // Throws BadData that names a key that nothing read, the one that was probably meant, and those that are understood.
  void finish() const;
  // Checks "schema": must be `expected`.
  void schema(std::string_view expected);

  [[nodiscard]] const std::string& source() const noexcept { return source_; }
  [[nodiscard]] const std::string& place() const noexcept { return place_; }
  // "file: /place: message (line 3)"; without a line where the source is no file
  [[noreturn]] void fail(std::string_view message) const;
  [[noreturn]] void fail_at(std::string_view key, std::string_view message) const;

 private:
  [[noreturn]] void refuse_unread(const std::string& key) const;

  const nlohmann::json* value_;
  std::string source_;
  std::string place_;
  mutable std::set<std::string, std::less<>> asked_;  // what the reader knows, there or not
  std::set<std::string, std::less<>> read_;
};

}  // namespace touchstone
