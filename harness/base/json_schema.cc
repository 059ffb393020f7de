#include "harness/base/json_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "harness/base/error.h"

namespace touchstone {
namespace {

using nlohmann::json;

json list_of(json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

class Schema {
 public:
  explicit Schema(std::span<const FileFormat> known) : known_(known) {}

  json document(const FileFormat& format) {
    json schema = object(format.fields);
    schema["title"] = format.schema;
    schema["description"] = format.summary;
    if (schema.contains("properties")) schema["properties"]["schema"] = {{"const", format.schema}};
    return schema;
  }
  [[nodiscard]] const json& definitions() const { return definitions_; }

 private:
  // An object of these fields; where none is described, of any.
  json object(std::span<const FormatField> fields) {
    Node root;
    for (const FormatField& field : fields) place(root, field.path, field);
    return of(root);
  }

  // The fields below an object; the key "*" is every other.
  struct Node {
    std::string key;
    const FormatField* field = nullptr;
    bool optional = false;
    std::vector<Node> below;
  };

  // Paths are from the object: "gap.train.before", "metrics[].name", "models.*"; "?" at the end.
  static void place(Node& root, std::string_view path, const FormatField& field) {
    const bool optional = path.ends_with('?');
    if (optional) path.remove_suffix(1);
    Node* at = &root;
    while (!path.empty()) {
      const std::size_t dot = path.find('.');
      std::string key(path.substr(0, dot));
      path = dot == std::string_view::npos ? "" : path.substr(dot + 1);
      if (key.ends_with("[]")) key.resize(key.size() - 2);
      const auto found = std::ranges::find(at->below, key, &Node::key);
      at = found == at->below.end() ? &at->below.emplace_back(Node{key, nullptr, false, {}}) : &*found;
    }
    at->field = &field;
    at->optional = optional;
    for (const FormatField& part : field.part) place(*at, part.path, part);
  }

  json of(const Node& node) {
    json schema{{"type", "object"}};
    if (node.below.empty()) return schema;
    schema["additionalProperties"] = false;
    for (const Node& child : node.below) {
      if (child.key == "*") {
        schema["additionalProperties"] = value(child);
        continue;
      }
      schema["properties"][child.key] = value(child);
      if (!child.optional) schema["required"].push_back(child.key);
    }
    if (!schema.contains("properties")) schema["properties"] = json::object();
    return schema;
  }

  json value(const Node& node) {
    if (node.field == nullptr) return of(node);
    json any = json::array();
    constexpr std::string_view otherwise = " or ";
    std::string_view types = node.field->type;
    while (!types.empty()) {
      const std::size_t at = types.find(otherwise);
      any.push_back(of_type(types.substr(0, at), node));
      types = at == std::string_view::npos ? "" : types.substr(at + otherwise.size());
    }
    json schema = any.size() == 1 ? any.front() : json{{"anyOf", any}};
    schema["description"] =
        node.field->meaning + (node.field->unit.empty() ? "" : fmt::format(" [{}]", node.field->unit));
    return schema;
  }

  json of_type(std::string_view type, const Node& node) {
    static const json number_or_null{{"type", {"number", "null"}}};
    if (type == "null") return {{"type", "null"}};
    if (type == "text") return {{"type", "string"}};
    if (type == "number") return {{"type", "number"}};
    if (type == "whole number") return {{"type", "integer"}};
    if (type == "flag") return {{"type", "boolean"}};
    if (type == "object") return of(node);
    if (type == "list of objects") return list_of(of(node));
    if (type == "list of texts") return list_of({{"type", "string"}});
    if (type == "list of flags") return list_of({{"type", "boolean"}});
    if (type == "list of numbers") return list_of(number_or_null);
    if (type == "list of lists of numbers") return list_of(list_of(number_or_null));
    if (type == "list of lists of texts") return list_of(list_of({{"type", "string"}}));
    if (type.starts_with("touchstone-")) return reference(std::string(type));
    return json::object();  // anything
  }

  json reference(const std::string& name) {
    const auto other = std::ranges::find(known_, name, &FileFormat::schema);
    if (other == known_.end()) return {{"type", "object"}};
    std::string key = name;
    std::ranges::replace(key, '/', '-');  // a slash would be a step of the pointer
    if (!definitions_.contains(key)) {
      definitions_[key] = json::object();  // it may hold itself
      definitions_[key] = document(*other);
    }
    return {{"$ref", "#/$defs/" + key}};
  }

  std::span<const FileFormat> known_;
  json definitions_ = json::object();
};

}  // namespace

json json_schema_of(const FileFormat& format, std::span<const FileFormat> known) {
  if (std::ranges::any_of(format.fields, [](const FormatField& field) { return field.type == "column"; }))
    throw UsageError(format.schema + " is a table of columns and no JSON: it has no schema");
  Schema made(known);
  json schema = made.document(format);
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  if (!made.definitions().empty()) schema["$defs"] = made.definitions();
  return schema;
}

}  // namespace touchstone
