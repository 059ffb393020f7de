// The formats of acquisition: its description, and its reports.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::acquisition {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::acquisition
