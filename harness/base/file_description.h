// What a file holds, by the table of its format (file_format.h): as Markdown, as text, and where the two differ.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "harness/base/file_format.h"

namespace touchstone {

// Where the document is not what the format says, a line each: keys that are not described, keys that are always there
// and are not, values of another type. `known`: the formats that others may contain.
std::vector<std::string> differences_from(const FileFormat& format, const nlohmann::json& document,
                                          std::span<const FileFormat> known);

// The keys of the format that occur in the document, by path, without those of documents of other formats within it.
std::vector<std::string> keys_seen(const FileFormat& format, const nlohmann::json& document);

// Every key of the format, by path, those of shared parts among them; columns, and names that are data ("*"), are not.
std::vector<std::string> keys_of(const FileFormat& format);

// A section of Markdown with one row for each key, those of shared parts among them.
std::string format_markdown(const FileFormat& format);
// The same for a terminal; with `document` only the keys that occur in it.
std::string format_text(const FileFormat& format, const nlohmann::json* document = nullptr);

}  // namespace touchstone
