#include "harness/base/json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/base/known_names.h"

namespace touchstone {
namespace {

std::string line_and_column(std::string_view text, std::size_t byte) {
  std::size_t line = 1;
  std::size_t column = 1;
  for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
    if (text[i] == '\n') {
      ++line;
      column = 1;
    } else {
      ++column;
    }
  }
  return fmt::format("line {}, column {}", line, column);
}

// Counts the lines that a parser has read.
struct LineCounter {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  const char* at = nullptr;
  std::size_t* line = nullptr;

  reference operator*() const { return *at; }
  LineCounter& operator++() {
    if (*at++ == '\n') ++*line;
    return *this;
  }
  bool operator==(const LineCounter& other) const { return at == other.at; }
};

// The line of one key or element, by its place; stops there.
class LineFinder : public nlohmann::json_sax<nlohmann::json> {
 public:
  LineFinder(std::string place, const std::size_t* line) : wanted_(std::move(place)), line_(line) {}
  [[nodiscard]] std::size_t found() const { return found_; }

  bool null() override { return element(); }
  bool boolean(bool) override { return element(); }
  bool number_integer(number_integer_t) override { return element(); }
  bool number_unsigned(number_unsigned_t) override { return element(); }
  bool number_float(number_float_t, const string_t&) override { return element(); }
  bool string(string_t&) override { return element(); }
  bool binary(binary_t&) override { return element(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    levels_.back().last = name;
    return note();
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  struct Level {
    bool list = false;
    std::size_t elements = 0;
    std::string last;
  };
  bool note() {
    std::string place;
    for (const Level& level : levels_) place += "/" + level.last;
    if (place == wanted_) found_ = *line_;
    return found_ == 0;
  }
  bool element() {
    if (levels_.empty() || !levels_.back().list) return true;
    levels_.back().last = std::to_string(levels_.back().elements++);
    return note();
  }
  bool open(bool list) {
    const bool on = element();
    levels_.push_back({list, 0, ""});
    return on;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  std::string wanted_;
  const std::size_t* line_;
  std::size_t found_ = 0;
  std::vector<Level> levels_;
};

}  // namespace

std::string line_in_file(const std::string& source, const std::string& place) {
  const std::size_t within = std::min(source.find(": /"), source.size());
  const std::string file = source.substr(0, within);
  const std::string whole = (within == source.size() ? "" : source.substr(within + 2)) + place;
  std::error_code error;
  if (whole.empty() || !std::filesystem::is_regular_file(file, error)) return {};
  std::size_t line = 1;
  LineFinder finder(whole, &line);
  try {
    const std::string text = read_file(file);
    nlohmann::json::sax_parse(LineCounter{text.data(), &line}, LineCounter{text.data() + text.size(), &line}, &finder);
  } catch (const std::exception&) {
    return {};
  }
  return finder.found() == 0 ? "" : fmt::format(" (line {})", finder.found());
}

nlohmann::json load_json(const std::filesystem::path& path) {
  note_input_file(path);
  return parse_json(read_file(path), path.string());
}

nlohmann::json parse_json(std::string_view text, std::string_view source) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw BadData(fmt::format("{}: is empty; a JSON object was expected", source));
  }
  std::vector<std::set<std::string>> seen;
  const auto refuse_duplicates = [&](int, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) seen.emplace_back();
    if (event == Event::object_end) seen.pop_back();
    if (event == Event::key && !seen.back().insert(parsed.get<std::string>()).second) {
      throw BadData(fmt::format("{}: the key {} stands twice in one object; remove one", source, parsed.dump()));
    }
    return true;
  };
  try {
    return nlohmann::json::parse(text, refuse_duplicates);
  } catch (const nlohmann::json::parse_error& error) {
    std::string_view reason = error.what();
    if (const auto at = reason.find(": "); at != std::string_view::npos) reason.remove_prefix(at + 2);
    throw BadData(fmt::format("{}: {}: not valid JSON: {}", source, line_and_column(text, error.byte), reason));
  } catch (const nlohmann::json::exception& error) {
    throw BadData(fmt::format("{}: not valid JSON: {}", source, error.what()));
  }
}

JsonObject::JsonObject(const nlohmann::json& value, std::string source, std::string place)
    : value_(&value), source_(std::move(source)), place_(std::move(place)) {
  if (!value.is_object()) fail(fmt::format("an object {{...}} was expected, got {}", value.type_name()));
}

bool JsonObject::has(std::string_view key) const {
  asked_.emplace(key);
  return value_->contains(key);
}

const nlohmann::json& JsonObject::raw(std::string_view key) {
  const auto found = value_->find(key);
  asked_.emplace(key);
  if (found == value_->end()) {
    std::vector<std::string> unread = keys();
    std::erase_if(unread, [&](const std::string& name) { return read_.contains(name); });
    // Where one of two keys may stand, the other may be the misspelt one.
    for (const std::string& name : unread) {
      for (const std::string& asked : asked_) {
        if (!value_->contains(asked) && is_one_slip(name, asked)) refuse_unread(name);
      }
    }
    std::string meant = closest_name(key, unread);
    if (!meant.empty())
      meant = fmt::format("; is \"{}\"{} meant to be it?", meant, line_in_file(source_, place_ + "/" + meant));
    fail(fmt::format("the key \"{}\" is missing{}; present: {}", key, meant, fmt::join(keys(), ", ")));
  }
  read_.emplace(key);
  return *found;
}

double JsonObject::number(std::string_view key) {
  const auto& value = raw(key);
  if (!value.is_number()) fail_at(key, fmt::format("a number was expected, got {}", value.dump()));
  const double number = value.get<double>();
  if (!std::isfinite(number)) fail_at(key, fmt::format("a finite number was expected, got {}", value.dump()));
  return number;
}

std::string JsonObject::text(std::string_view key) {
  const auto& value = raw(key);
  if (!value.is_string()) fail_at(key, fmt::format("a text was expected, got {}", value.dump()));
  return value.get<std::string>();
}

JsonObject JsonObject::object(std::string_view key) { return {raw(key), source_, fmt::format("{}/{}", place_, key)}; }

std::vector<JsonObject> JsonObject::objects(std::string_view key) {
  const auto& value = raw(key);
  if (!value.is_array()) fail_at(key, fmt::format("a list [...] was expected, got {}", value.type_name()));
  std::vector<JsonObject> objects;
  objects.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i)
    objects.emplace_back(value[i], source_, fmt::format("{}/{}/{}", place_, key, i));
  return objects;
}

std::vector<double> JsonObject::numbers(std::string_view key) {
  const auto& value = raw(key);
  if (!value.is_array()) fail_at(key, fmt::format("a list of numbers was expected, got {}", value.type_name()));
  std::vector<double> numbers;
  for (const auto& item : value) {
    if (!item.is_number() || !std::isfinite(item.get<double>())) {
      fail_at(key, fmt::format("a list of finite numbers was expected, got {}", item.dump()));
    }
    numbers.push_back(item.get<double>());
  }
  return numbers;
}

std::optional<double> JsonObject::optional_number(std::string_view key) {
  return has(key) ? std::optional(number(key)) : std::nullopt;
}

std::optional<std::string> JsonObject::optional_text(std::string_view key) {
  return has(key) ? std::optional(text(key)) : std::nullopt;
}

std::optional<bool> JsonObject::optional_flag(std::string_view key) {
  if (!has(key)) return std::nullopt;
  const auto& value = raw(key);
  if (!value.is_boolean()) fail_at(key, fmt::format("true or false was expected, got {}", value.dump()));
  return value.get<bool>();
}

std::string JsonObject::text_of_all() const { return value_->dump(); }

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> names;
  for (const auto& item : value_->items()) names.push_back(item.key());
  return names;
}

void JsonObject::refuse_unread(const std::string& key) const {
  const std::string meant = closest_name(key, {asked_.begin(), asked_.end()});
  throw BadData(fmt::format("{}: {}: nothing reads the key \"{}\"{}; {}the keys understood here are: {}", source_,
                            place_.empty() ? "/" : place_, key, line_in_file(source_, place_ + "/" + key),
                            meant.empty() ? "" : fmt::format("did you mean \"{}\"? ", meant), fmt::join(asked_, ", ")));
}

void JsonObject::finish() const {
  for (const auto& key : keys()) {
    if (!read_.contains(key)) refuse_unread(key);
  }
}

void JsonObject::schema(std::string_view expected) {
  const auto found = text("schema");
  if (found != expected) fail_at("schema", fmt::format("\"{}\" was expected, got \"{}\"", expected, found));
}

void JsonObject::fail(std::string_view message) const {
  throw BadData(
      fmt::format("{}: {}: {}{}", source_, place_.empty() ? "/" : place_, message, line_in_file(source_, place_)));
}

void JsonObject::fail_at(std::string_view key, std::string_view message) const {
  const std::string place = fmt::format("{}/{}", place_, key);
  throw BadData(fmt::format("{}: {}: {}{}", source_, place, message, line_in_file(source_, place)));
}

}  // namespace touchstone
