// What the files that this program writes and reads hold: one table of keys beside each writer, from which
// docs/reference/formats.md is made, which `touchstone formats` prints, and which tests hold against files that were
// written. A room that owns formats has them in its file_formats.h.
#pragma once

#include <span>
#include <string_view>

namespace touchstone {

struct FormatField;

// Keys that several formats share, such as those of a metric.
struct FormatPart {
  std::span<const FormatField> fields;
};

// One key of a JSON file, or one column of a table.
struct FormatField {
  // From the root: "gap.train.before"; "metrics[].name" is of every element of a list, "models.*" of every key whose
  // name is data. "?" at the end: the key may be absent.
  std::string_view path;
  // "text", "number", "whole number", "flag", "object", "list of texts", "list of flags", "list of numbers", "list of
  // lists of numbers", "list of objects", "any", or the name of another format whose document stands here; " or null"
  // may follow. Elements of lists of numbers may be null. "column" of a table.
  std::string_view type;
  std::string_view unit;             // SI, or "" where there is none
  std::string_view meaning;          // a phrase
  const FormatPart* part = nullptr;  // what the object, or each object of the list, holds
};

struct FileFormat {
  std::string_view schema;               // "touchstone-result/1"
  std::string_view file;                 // how the file is usually called
  std::string_view summary;              // a phrase
  std::string_view written_by, read_by;  // commands, or ""
  std::span<const FormatField> fields;   // but "schema", which every format has
  // Internal formats may change with any version; those without fields here are described by their source alone.
  bool internal = false;
};

}  // namespace touchstone
