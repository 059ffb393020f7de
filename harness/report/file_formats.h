// The formats of result.json and of the catalogue, and the keys that other results share with them.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::report {

extern const FormatPart metric_part;
extern const FormatPart series_part;
extern const FormatPart provenance_part;
extern const FormatPart input_part;

std::span<const FileFormat> file_formats();

}  // namespace touchstone::report
