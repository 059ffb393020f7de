// The formats of model, effect and scene files, and of what a replay says of itself.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::rendering {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::rendering
