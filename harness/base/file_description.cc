#include "harness/base/file_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace touchstone {
namespace {

using nlohmann::json;

// A field with its whole path, that of the parts above it included.
struct Flat {
  std::string path;
  bool optional = false;
  const FormatField* field = nullptr;
};

bool is_list_of_objects(const FormatField& field) { return field.type.starts_with("list of objects"); }

void flatten(std::span<const FormatField> fields, const std::string& above, std::vector<Flat>& out) {
  for (const FormatField& field : fields) {
    const bool optional = field.path.ends_with('?');
    const std::string path = above + (optional ? field.path.substr(0, field.path.size() - 1) : field.path);
    out.push_back({path, optional, &field});
    flatten(field.part, path + (is_list_of_objects(field) ? "[]." : "."), out);
  }
}

std::vector<Flat> flattened(const FileFormat& format) {
  std::vector<Flat> out;
  flatten(format.fields, "", out);
  return out;
}

// The last key of a path, and the path of the object that has it ("" for the root).
std::pair<std::string, std::string> split(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) return {"", path};
  return {path.substr(0, dot), path.substr(dot + 1)};
}

bool all_of_elements(const json& value, bool (*is)(const json&)) {
  return value.is_array() && std::ranges::all_of(value, [&](const json& one) { return is(one); });
}

bool is_number_or_null(const json& value) { return value.is_number() || value.is_null(); }

bool is_list_of_numbers(const json& value) { return all_of_elements(value, is_number_or_null); }

bool is_text(const json& value) { return value.is_string(); }

bool is_object(const json& value) { return value.is_object(); }

bool is_flag(const json& value) { return value.is_boolean(); }

bool is_list_of_texts(const json& value) { return all_of_elements(value, is_text); }

// The name of the format whose document stands here; "" if none does.
std::string_view inner_format(std::string_view type) {
  const std::size_t at = type.find("touchstone-");
  if (at == std::string_view::npos) return "";
  return type.substr(at, type.find(' ', at) - at);
}

bool has_type(const json& value, std::string_view type) {
  constexpr std::string_view otherwise = " or ";
  if (const std::size_t at = type.find(otherwise); at != std::string_view::npos)
    return has_type(value, type.substr(0, at)) || has_type(value, type.substr(at + otherwise.size()));
  if (type == "null") return value.is_null();
  if (type == "any") return true;
  if (type == "text") return value.is_string();
  if (type == "number") return value.is_number();
  if (type == "whole number") return value.is_number_integer();
  if (type == "flag") return value.is_boolean();
  if (type == "object" || type.starts_with("touchstone-")) return value.is_object();
  if (type == "list of texts") return is_list_of_texts(value);
  if (type == "list of flags") return all_of_elements(value, is_flag);
  if (type == "list of numbers") return is_list_of_numbers(value);
  if (type == "list of lists of numbers") return all_of_elements(value, is_list_of_numbers);
  if (type == "list of lists of texts") return all_of_elements(value, is_list_of_texts);
  if (type == "list of objects") return all_of_elements(value, is_object);
  return false;
}

// Walks a document along the table of its format.
class Walk {
 public:
  Walk(const FileFormat& format, std::span<const FileFormat> known)
      : format_(format), fields_(flattened(format)), known_(known) {}

  void object(const json& value, const std::string& path, const std::string& place) {
    for (const Flat& flat : fields_) {
      const auto [owner, key] = split(flat.path);
      if (owner == path && key != "*" && !flat.optional && !value.contains(key))
        differences_.push_back(
            fmt::format("{}: {}/{} is not there; the format says that it always is", format_.schema, place, key));
    }
    for (const auto& [key, below] : value.items()) {
      if (path.empty() && key == "schema") continue;
      const std::string prefix = path.empty() ? "" : path + ".";
      const Flat* found = find(prefix + key);
      if (found == nullptr) found = find(prefix + "*");
      if (found == nullptr) {
        differences_.push_back(fmt::format("{}: {}/{} is not described", format_.schema, place, key));
      } else {
        member(below, *found, place + "/" + key);
      }
    }
  }

  [[nodiscard]] const std::vector<std::string>& differences() const { return differences_; }
  [[nodiscard]] const std::vector<std::string>& seen() const { return seen_; }

 private:
  [[nodiscard]] const Flat* find(const std::string& path) const {
    const auto at = std::ranges::find(fields_, path, &Flat::path);
    return at == fields_.end() ? nullptr : &*at;
  }

  void member(const json& value, const Flat& flat, const std::string& place) {
    const std::string_view type = flat.field->type;
    if (std::ranges::find(seen_, flat.path) == seen_.end()) seen_.push_back(flat.path);
    if (!has_type(value, type)) {
      differences_.push_back(
          fmt::format("{}: {} is {}; the format says {}", format_.schema, place, value.type_name(), type));
    } else if (value.is_array() && is_list_of_objects(*flat.field)) {
      for (std::size_t i = 0; i < value.size(); ++i) object(value[i], flat.path + "[]", fmt::format("{}/{}", place, i));
    } else if (value.is_object() && !inner_format(type).empty()) {
      inner(value, inner_format(type));
    } else if (value.is_object() && type.starts_with("object")) {
      object(value, flat.path, place);
    }
  }

  void inner(const json& value, std::string_view schema) {
    const auto other = std::ranges::find(known_, schema, &FileFormat::schema);
    if (other == known_.end()) return;
    const auto more = differences_from(*other, value, known_);
    differences_.insert(differences_.end(), more.begin(), more.end());
  }

  const FileFormat& format_;
  std::vector<Flat> fields_;
  std::span<const FileFormat> known_;
  std::vector<std::string> differences_;
  std::vector<std::string> seen_;
};

std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

std::string commands(const FileFormat& format) {
  std::string text;
  if (!format.written_by.empty()) text += fmt::format("Written by {}.", format.written_by);
  if (!format.read_by.empty()) text += fmt::format("{}Read by {}.", text.empty() ? "" : " ", format.read_by);
  return text;
}

}  // namespace

std::vector<std::string> differences_from(const FileFormat& format, const json& document,
                                          std::span<const FileFormat> known) {
  if (!document.is_object()) return {fmt::format("{}: the document is no object", format.schema)};
  Walk walk(format, known);
  walk.object(document, "", "");
  return walk.differences();
}

std::vector<std::string> keys_seen(const FileFormat& format, const json& document) {
  if (!document.is_object()) return {};
  Walk walk(format, {});
  walk.object(document, "", "");
  return walk.seen();
}

std::vector<std::string> keys_of(const FileFormat& format) {
  std::vector<std::string> keys;
  for (const Flat& flat : flattened(format)) {
    if (flat.field->type != "column" && !flat.path.ends_with('*')) keys.push_back(flat.path);
  }
  return keys;
}

std::string format_markdown(const FileFormat& format) {
  const bool plain = format.file.find('`') == std::string::npos;
  std::string text =
      fmt::format("\n## `{}`\n\n{}: {}. {}\n", format.schema, plain ? fmt::format("`{}`", format.file) : format.file,
                  format.summary, commands(format));
  if (format.internal) text += "Internal: it may change with any version.\n";
  if (format.fields.empty()) return text;
  text += "\n| key | type | unit | meaning |\n|---|---|---|---|\n";
  for (const Flat& flat : flattened(format)) {
    text += fmt::format("| `{}`{} | {} | {} | {} |\n", flat.path, flat.optional ? " (optional)" : "", flat.field->type,
                        flat.field->unit, cell(flat.field->meaning));
  }
  return text;
}

std::string format_text(const FileFormat& format, const json* document) {
  std::string text = fmt::format("{} ({}): {}\n", format.schema, format.file, format.summary);
  if (const std::string who = commands(format); !who.empty()) text += who + "\n";
  if (format.internal) text += "Internal: it may change with any version.\n";
  const std::vector<std::string> seen = document == nullptr ? std::vector<std::string>{} : keys_seen(format, *document);
  for (const Flat& flat : flattened(format)) {
    if (document != nullptr && std::ranges::find(seen, flat.path) == seen.end()) continue;
    text += fmt::format("  {}{}: {}{}, {}\n", flat.path, flat.optional && document == nullptr ? " (optional)" : "",
                        flat.field->type, flat.field->unit.empty() ? "" : fmt::format(" [{}]", flat.field->unit),
                        flat.field->meaning);
  }
  return text;
}

}  // namespace touchstone
