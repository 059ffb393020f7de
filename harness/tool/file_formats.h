// The formats of what `touchstone tool` says of a run and of a comparison.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::tool {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::tool
