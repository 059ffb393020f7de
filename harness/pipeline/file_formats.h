// The formats of a leaderboard and of its timings.
// One table of keys for each, from which `touchstone formats` and docs/reference/formats.md are made.
#pragma once

#include <span>

#include "harness/base/file_format.h"

namespace touchstone::pipeline {

std::span<const FileFormat> leaderboard_file_formats();

}  // namespace touchstone::pipeline
