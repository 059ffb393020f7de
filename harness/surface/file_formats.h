// The format of the diagnosis of a mesh.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::surface {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::surface
