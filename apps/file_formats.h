// Every file format that the program writes or reads, from the rooms that own them.
#pragma once

#include <vector>

#include "harness/base/file_format.h"

namespace touchstone::apps {

// Those that users read first; those that may change with any version last.
std::vector<const FileFormat*> file_formats();

}  // namespace touchstone::apps
