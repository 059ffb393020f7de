// The formats of recordings and of data sets.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::recording {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::recording
