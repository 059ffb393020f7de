// The formats of the catalogue of synthetic things and of goldens of tools.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::synthetic {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::synthetic
