#include <fmt/format.h>
#include <iconv.h>

#include <array>
#include <fstream>
#include <string_view>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

// Of text that begins with the mark of its order of bytes, as Windows programs write it.
std::string utf8_of_utf16(std::string text, const std::string& source) {
  const iconv_t converter = iconv_open("UTF-8", "UTF-16");
  constexpr std::size_t most_for_two = 3;
  std::string utf8(most_for_two * text.size(), '\0');
  char *from = text.data(), *to = utf8.data();
  std::size_t left = text.size(), room = utf8.size();
  const bool whole = iconv(converter, &from, &left, &to, &room) != static_cast<std::size_t>(-1);
  iconv_close(converter);
  if (!whole) throw BadData(fmt::format("{}: is UTF-16 text that is damaged at byte {}", source, text.size() - left));
  utf8.resize(utf8.size() - room);
  return utf8;
}

// What a zip archive is, by the names of its entries, which stand in its last bytes as they are.
std::vector<ImportTable> read_archive(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  constexpr std::size_t directory = 65536;
  const std::string_view end = std::string_view(bytes).substr(bytes.size() > directory ? bytes.size() - directory : 0);
  const auto has = [&](std::string_view name) { return end.find(name) != std::string_view::npos; };
  if (has(".npy")) return read_numpy_archive(path);
  if (has("xl/workbook.xml")) return read_excel_workbook(path);
  if (has("content.xml")) {
    throw BadData(fmt::format("{}: is an OpenDocument sheet, which is not read: save it as CSV", path.string()));
  }
  const std::string extension = path.extension().string();
  if (extension == ".xlsx" || extension == ".xlsm" || extension == ".npz") {
    throw BadData(
        fmt::format("{}: is damaged or was cut short: the list of what a {} holds is not at its end: copy it anew",
                    path.string(), extension));
  }
  throw BadData(fmt::format("{}: is a zip archive (.jpk-force files are ones): export the curve as text, or unpack it",
                            path.string()));
}

}  // namespace

ImportTable read_text_table(const std::filesystem::path& path, const TextLayout& layout) {
  std::string text = read_file(path);
  if (text.empty()) throw BadData(fmt::format("{}: is empty; a table of numbers was expected", path.string()));
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) text = utf8_of_utf16(text, path.string());
  if (std::string_view(text).substr(0, 4096).find('\0') != std::string_view::npos) {
    throw BadData(
        fmt::format("{}: is a binary file of no kind that can be read: text tables, .xlsx, MATLAB .mat, ROS bags "
                    "(.bag, .mcap, .db3), HDF5, .npy and .npz can",
                    path.string()));
  }
  return read_text_lines(path.string(), text, layout);
}

std::vector<ImportTable> read_foreign(const std::filesystem::path& path, const TextLayout& layout) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw BadData(fmt::format("{}: does not exist; is the path right?", path.string()));
  }
  if (std::filesystem::is_directory(path, error)) {
    throw BadData(
        fmt::format("{}: is a folder; a file was expected (of a ROS 2 bag, its .db3 or .mcap file)", path.string()));
  }
  const auto size = std::filesystem::file_size(path, error);
  if (error || size > largest_import_bytes) {
    throw BadData(fmt::format("{}: {} bytes; at most {} can be imported at once: cut it into pieces", path.string(),
                              error ? 0 : size, largest_import_bytes));
  }
  note_input_file(path);
  std::array<char, 128> start{};
  std::ifstream in(path, std::ios::binary);
  if (!in) throw BadData(fmt::format("{}: cannot be opened for reading; may you?", path.string()));
  in.read(start.data(), start.size());
  const std::string_view head(start.data(), static_cast<std::size_t>(in.gcount()));
  const std::string extension = path.extension().string();
  // What the bytes say goes before what the name says.
  if (head.starts_with("#ROSBAG")) return read_ros_bag(path);
  if (head.starts_with("SQLite format 3")) return read_ros2_database(path);
  if (head.starts_with("\x89MCAP0\r\n")) return read_mcap_file(path);
  if (head.starts_with("MATLAB") || extension == ".mat") return read_mat_file(path);
  if (head.starts_with("\x89HDF\r\n\x1a\n")) return read_hdf5_arrays(path);
  if (head.starts_with("\x93NUMPY")) return read_numpy_array(path);
  if (head.starts_with("TDSm")) return read_tdms_file(path);
  if (head.starts_with("PK\x03\x04")) return read_archive(path);
  refuse_known_kind(path, head);
  return {read_text_table(path, layout)};
}

}  // namespace touchstone::importing
