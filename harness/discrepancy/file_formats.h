// The formats of findings.json and of the description of a sensor and a tracker.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::discrepancy {

std::span<const FileFormat> file_formats();

}  // namespace touchstone::discrepancy
