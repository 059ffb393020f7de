// The format of a fit of one axis.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::axis {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::axis
