#include "harness/base/json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
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

}  // namespace

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
    const std::string meant = closest_name(key, unread);
    fail(fmt::format("the key \"{}\" is missing{}; present: {}", key,
                     meant.empty() ? "" : fmt::format("; is \"{}\" meant to be it?", meant), fmt::join(keys(), ", ")));
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

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> names;
  for (const auto& item : value_->items()) names.push_back(item.key());
  return names;
}

void JsonObject::finish() const {
  for (const auto& key : keys()) {
    if (!read_.contains(key)) {
      const std::string meant = closest_name(key, {asked_.begin(), asked_.end()});
      fail(fmt::format("nothing reads the key \"{}\"; {}the keys understood here are: {}", key,
                       meant.empty() ? "" : fmt::format("did you mean \"{}\"? ", meant), fmt::join(asked_, ", ")));
    }
  }
}

void JsonObject::schema(std::string_view expected) {
  const auto found = text("schema");
  if (found != expected) fail_at("schema", fmt::format("\"{}\" was expected, got \"{}\"", expected, found));
}

void JsonObject::fail(std::string_view message) const {
  throw BadData(fmt::format("{}: {}: {}", source_, place_.empty() ? "/" : place_, message));
}

void JsonObject::fail_at(std::string_view key, std::string_view message) const {
  throw BadData(fmt::format("{}: {}/{}: {}", source_, place_, key, message));
}

}  // namespace touchstone
