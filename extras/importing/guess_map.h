// A first map for a foreign file, from the names and the numbers of its columns, each line of it with its reason. A
// proposal to be read and corrected: what a column means, only who recorded it knows.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "import_file.h"

namespace touchstone::importing {

struct GuessedMap {
  std::string json;                         // the map with its reasons, ready to be written
  std::vector<std::string> reasons;         // one for each decision
  std::vector<std::string> unused;          // columns, each with why
  std::vector<std::string> missing;         // what a recording needs and nothing was found for
  std::vector<std::string> decide;          // what the file leaves open; `import` takes the map when they are decided
  std::map<std::string, std::string> from;  // columns of the result and what the file calls them
  bool static_poses = false;                // not a motion: `acquire tool` weighs the tool in them
  std::set<std::string> unit_assumed;       // columns of the result whose unit nothing states
  std::set<std::string> sign_assumed;       // and those of which no axis is named
  std::optional<Imported> read;             // what is certain, as the map reads it
  std::string unreadable;                   // or why it cannot be read so
};

GuessedMap guess_map(const std::filesystem::path& path);

}  // namespace touchstone::importing
