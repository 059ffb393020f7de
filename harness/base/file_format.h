// What the files that this program and its extras write and read hold: tables of keys, kept as data beside each writer
// (formats.json of a room or of an extra), from which docs/reference/formats.md is made, which `touchstone formats`
// prints, and which tests hold against files that were written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone {

// One key of a JSON file, or one column of a table.
struct FormatField {
  // From the root: "gap.train.before"; "metrics[].name" is of every element of a list, "models.*" of every key whose
  // name is data. "?" at the end: the key may be absent.
  std::string path;
  // "text", "number", "whole number", "flag", "object", "list of texts", "list of flags", "list of numbers", "list of
  // lists of numbers", "list of objects", "any", or the name of another format whose document stands here; " or null"
  // may follow. Elements of lists of numbers may be null. "column" of a table.
  std::string type;
  std::string unit;     // SI, or "" where there is none
  std::string meaning;  // a phrase
  // What the object, or each object of the list, holds.
  std::vector<FormatField> part = {};
};

struct FileFormat {
  std::string schema;               // "touchstone-result/1"
  std::string file;                 // how the file is usually called
  std::string summary;              // a phrase
  std::string written_by, read_by;  // commands, or ""
  std::vector<FormatField> fields;  // but "schema", which every format has
  // Internal formats may change with any version; those without fields here are described by their source alone.
  bool internal = false;
};

// The formats of tables "touchstone-formats/1", by name, those that may change with any version last:
//   {"schema": "touchstone-formats/1",
//    "parts": {"metric": [{"path": "name", "type": "text", "meaning": "which"}, ...]},
//    "formats": [{"schema": "touchstone-result/1", "file": "result.json", "summary": "...", "written_by": "`evaluate`",
//                 "fields": [{"path": "metrics", "type": "list of objects", "meaning": "each", "part": "metric"},
//                 ...]}]}
// A part that several formats share, in whatever table, is named; one that is used once may stand in its place.
// Throws BadData with file and place.
std::vector<FileFormat> load_formats(const std::vector<std::filesystem::path>& tables);

}  // namespace touchstone
