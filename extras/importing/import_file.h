// A foreign file, read as a map says, to the columns of a recording (or of static poses, or of one axis).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "import_map.h"

namespace touchstone::importing {

struct Imported {
  std::vector<std::string> names;  // t_s first, then in the order of recordings
  std::vector<std::vector<double>> columns;
  std::vector<std::string> notes;
  std::string format;  // of the main file
};

// Throws BadData naming the file, the map, place and value.
Imported import_file(const std::filesystem::path& path, const ImportMap& map);

// Samples, rate, and each column's first value, range and course as a line of bars: a table for people, 80 wide.
// `from`: the file's own names of the columns.
std::string imported_text(const Imported& imported, const std::map<std::string, std::string>& from = {});
// The columns over time (or over the samples), as an SVG picture.
std::string imported_picture(const Imported& imported, const std::string& title);
// Writes CSV; atomic. A recording (t, x, y, z, f...) is read back and checked as every command does.
void save_imported(const std::filesystem::path& path, const Imported& imported);

}  // namespace touchstone::importing
