// A first map for a foreign file, from the names and the numbers of its columns, each line of it with its reason. A
// proposal to be read and corrected: what a column means, only who recorded it knows.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/rooms.h"

namespace touchstone::importing {

struct GuessedMap {
  std::string json;                  // the map, ready to be written
  std::vector<std::string> reasons;  // one for each decision
  std::vector<std::string> missing;  // what a recording needs and nothing was found for
  std::vector<std::string> decide;   // what the file leaves open; `import` takes the map when they are decided
};

GuessedMap guess_map(const std::filesystem::path& path);

}  // namespace touchstone::importing
