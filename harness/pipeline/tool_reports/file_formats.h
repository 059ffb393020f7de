// The format of the scorecard of tools with a shape.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::pipeline {

std::span<const FileFormat> tool_report_file_formats();

}  // namespace touchstone::pipeline
