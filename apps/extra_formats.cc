#include "apps/extra_formats.h"

#include <algorithm>
#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/report/file_formats.h"

namespace touchstone::apps {
namespace {

// What the views of the tables point to; a deque leaves its elements where they are.
struct Kept {
  std::deque<std::string> texts;
  std::deque<std::vector<FormatField>> fields;
  std::deque<FormatPart> parts;
  std::deque<FileFormat> formats;

  std::string_view text(JsonObject& object, std::string_view key) {
    return texts.emplace_back(object.optional_text(key).value_or(""));
  }

  // A list of fields, or "provenance", which many files share.
  const FormatPart* read_part(JsonObject& object) {
    if (object.raw("part").is_string()) {
      if (object.text("part") != "provenance")
        object.fail_at("part", "a list of fields or \"provenance\" was expected");
      return &report::provenance_part;
    }
    return &parts.emplace_back(FormatPart{read_fields(object, "part")});
  }

  std::span<const FormatField> read_fields(JsonObject& object, std::string_view key) {
    if (!object.has(key)) return {};
    std::vector<FormatField>& out = fields.emplace_back();
    for (JsonObject& one : object.objects(key)) {
      FormatField field{text(one, "path"), text(one, "type"), text(one, "unit"), text(one, "meaning")};
      if (one.has("part")) field.part = read_part(one);
      one.finish();
      out.push_back(field);
    }
    return out;
  }

  void read(const std::filesystem::path& file) {
    const nlohmann::json document = load_json(file);
    JsonObject root(document, file.string(), "");
    root.schema("touchstone-formats/1");
    for (JsonObject& one : root.objects("formats")) {
      formats.push_back({text(one, "schema"), text(one, "file"), text(one, "summary"), text(one, "written_by"),
                         text(one, "read_by"), read_fields(one, "fields"),
                         one.optional_flag("internal").value_or(false)});
      one.finish();
    }
    root.finish();
  }
};

Kept read_tables() {
  Kept kept;
  const auto folder = find_bundled("formats");
  if (!folder) return kept;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files) kept.read(file);
  return kept;
}

}  // namespace

std::vector<const FileFormat*> extra_formats() {
  static const Kept kept = read_tables();
  std::vector<const FileFormat*> out;
  for (const FileFormat& format : kept.formats) out.push_back(&format);
  return out;
}

}  // namespace touchstone::apps
