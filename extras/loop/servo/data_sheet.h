// What is published of a device or of a hand, figure by figure with its source, as a JSON file that people can write:
//   {"schema": "touchstone-device/1", "name": "Touch",
//    "figures": {"resolution_m": {"value": 5.5e-5, "source": "...", "read_in": "..."}},
//    "not_published": {"damping_N_s_per_m": "why there is none"}}
// `read_in` names the text in which the figure was read; without it the figure is cited from memory. A grip is the same
// with the schema touchstone-grip/1. Sheets of ten devices and three grips come with the program.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::servo {

struct Figure {
  double value = 0.0;
  std::string source;
  std::string read_in;  // empty: cited from memory, not checked
};

struct FigureEntry {
  std::string_view name;  // carries its unit
  std::string_view unit;
  std::string_view meaning;
  bool above_zero = false;  // else not below it
};
const std::vector<FigureEntry>& device_entries();
const std::vector<FigureEntry>& grip_entries();

struct DataSheet {
  std::string name;
  std::filesystem::path file;
  std::map<std::string, Figure, std::less<>> figures;
  std::map<std::string, std::string, std::less<>> not_published;  // name and why

  [[nodiscard]] std::optional<double> value(std::string_view name) const;
};

// Where the folders devices/ and grips/ are; found beside the program where this is not called.
void use_sheets_in(const std::filesystem::path& folder);
// The names of the sheets that come with the program, in alphabetical order.
std::vector<std::string> device_names();
std::vector<std::string> grip_names();

// `wanted`: one of these names, or a file. Throws UsageError for a name that is not known, BadData with the place for a
// figure that has another name, no source or a value out of range.
DataSheet find_device(const std::string& wanted);
DataSheet find_grip(const std::string& wanted);

}  // namespace touchstone::servo
