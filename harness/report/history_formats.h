// The formats of the judgement of metrics over builds.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::report {

std::span<const FileFormat> history_file_formats();

}  // namespace touchstone::report
