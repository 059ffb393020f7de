#include "harness/base/file_format.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"

namespace touchstone {
namespace {

constexpr const char* schema = "touchstone-formats/1";

class Tables {
 public:
  explicit Tables(const std::vector<std::filesystem::path>& files) {
    for (const auto& file : files) documents_.emplace_back(file.string(), load_json(file));
    for (const auto& [file, document] : documents_) {
      JsonObject root(document, file, "");
      root.schema(schema);
      root.raw("formats");
      if (root.has("parts")) take_parts(root.object("parts"));
      root.finish();
    }
  }

  std::vector<FileFormat> formats() {
    std::vector<FileFormat> out;
    for (const auto& [file, document] : documents_) {
      JsonObject root(document, file, "");
      for (JsonObject& one : root.objects("formats")) {
        FileFormat format{one.text("schema"),
                          one.text("file"),
                          one.text("summary"),
                          one.optional_text("written_by").value_or(""),
                          one.optional_text("read_by").value_or(""),
                          {},
                          one.optional_flag("internal").value_or(false)};
        if (one.has("fields")) format.fields = fields(one.objects("fields"));
        one.finish();
        out.push_back(std::move(format));
      }
    }
    std::ranges::stable_sort(out, {}, [](const FileFormat& f) { return std::tuple(f.internal, f.schema); });
    const auto twice = std::ranges::adjacent_find(out, {}, &FileFormat::schema);
    if (twice != out.end()) throw BadData(twice->schema + ": two tables describe this format");
    return out;
  }

 private:
  void take_parts(JsonObject parts) {
    for (const std::string& name : parts.keys()) {
      if (!parts_.emplace(name, parts.objects(name)).second)
        parts.fail_at(name, "a part of this name is described already");
    }
  }

  std::vector<FormatField> fields(std::vector<JsonObject> rows) {
    std::vector<FormatField> out;
    for (JsonObject& row : rows) {
      FormatField field{row.text("path"), row.text("type"), row.optional_text("unit").value_or(""),
                        row.text("meaning")};
      if (row.has("part")) field.part = row.raw("part").is_string() ? named_part(row) : fields(row.objects("part"));
      row.finish();
      out.push_back(std::move(field));
    }
    return out;
  }

  std::vector<FormatField> named_part(JsonObject& row) {
    const std::string name = row.text("part");
    const auto part = parts_.find(name);
    if (part == parts_.end()) row.fail_at("part", "no table describes a part '" + name + "'");
    if (std::ranges::count(open_, name) > 0) row.fail_at("part", "the part '" + name + "' holds itself");
    open_.push_back(name);
    std::vector<FormatField> out = fields(part->second);
    open_.pop_back();
    return out;
  }

  std::vector<std::pair<std::string, nlohmann::json>> documents_;
  std::map<std::string, std::vector<JsonObject>> parts_;
  std::vector<std::string> open_;  // the parts that are being read, each within the one before it
};

}  // namespace

std::vector<FileFormat> load_formats(const std::vector<std::filesystem::path>& tables) {
  return Tables(tables).formats();
}

}  // namespace touchstone
