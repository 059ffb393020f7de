// What the readers of foreign files have in common: tables of named columns, before a map says what they mean. A table
// of text has one; a bag has one for each topic, a .mat file one for each length of its arrays.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::importing {

struct ImportTable {
  std::string name;                          // of the topic or group; "" where a file has one table
  std::vector<std::string> names;            // of the columns; c1, c2, ... where the file names none
  std::vector<std::vector<double>> columns;  // all of one length; NaN where a value is missing
  std::vector<std::string> notes;            // what was skipped or assumed
  std::string source;                        // the file
  std::string format;                        // "text table: tabs, decimal commas", "MATLAB v5", ...
  bool names_from_file = false;
  // What the file says of a column beyond its name, to be read in its place by the grammar of names: "Time (s)" of a
  // column named X_Value, "Load (N)" where a row of units stands below the names. Empty, or as many as `names`.
  std::vector<std::string> described;
  std::vector<std::string> head;  // lines of text before the numbers
  std::vector<char> text;         // columns that hold text, which are NaN throughout; empty: none

  [[nodiscard]] const std::string& description(std::size_t c) const {
    return c < described.size() && !described[c].empty() ? described[c] : names[c];
  }
  [[nodiscard]] bool is_text(std::size_t c) const { return c < text.size() && text[c] != 0; }
  [[nodiscard]] std::size_t rows() const noexcept { return columns.empty() ? 0 : columns.front().size(); }
};

// How a text table is laid out; empty fields are found from the file.
struct TextLayout {
  std::string separator;  // "comma", "semicolon", "tab", "space"
  std::string decimal;    // "point", "comma"
  std::string comment;    // lines that begin with it hold no data
  std::vector<std::string> names;
};

// Files larger than this are no tables of one recording: they are read whole.
inline constexpr std::uintmax_t largest_import_bytes = std::uintmax_t{2} << 30;

// Deflate packs at most so many bytes into one (zlib's technical notes): a larger array than that is not in the file.
inline constexpr std::size_t most_packed = 1032;

// Every table of a file, by what the file is: MATLAB, ROS bag, HDF5, NumPy, text. Throws BadData naming file, line and
// column.
std::vector<ImportTable> read_foreign(const std::filesystem::path& path, const TextLayout& layout);

// The readers; each throws BadData.
ImportTable read_text_table(const std::filesystem::path& path, const TextLayout& layout);
// Of lines that are in memory: `source` stands in messages for the file.
ImportTable read_text_lines(const std::string& source, std::string_view lines, const TextLayout& layout);
std::vector<ImportTable> read_excel_workbook(const std::filesystem::path& path);  // .xlsx
std::vector<ImportTable> read_mat_file(const std::filesystem::path& path);
std::vector<ImportTable> read_hdf5_arrays(const std::filesystem::path& path);
std::vector<ImportTable> read_numpy_array(const std::filesystem::path& path);    // .npy
std::vector<ImportTable> read_numpy_archive(const std::filesystem::path& path);  // .npz
std::vector<ImportTable> read_ros_bag(const std::filesystem::path& path);        // version 2.0 of ROS 1
std::vector<ImportTable> read_ros2_database(const std::filesystem::path& path);  // SQLite storage of ROS 2
std::vector<ImportTable> read_tdms_file(const std::filesystem::path& path);      // .tdms of LabVIEW and DIAdem
std::vector<ImportTable> read_mcap_file(const std::filesystem::path& path);      // MCAP storage of ROS 2

// Throws BadData with what the file is and what to do, if its first bytes are those of a format that is known but not
// read.
void refuse_known_kind(const std::filesystem::path& path, std::string_view head);

}  // namespace touchstone::importing
