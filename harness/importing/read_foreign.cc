#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string_view>

#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/importing/import_table.h"
#include "harness/recording/table_source.h"

namespace touchstone::importing {
namespace {

// A recording of ours in HDF5, or one whose datasets are columns.
std::vector<ImportTable> read_hdf5_columns(const std::filesystem::path& path) {
  const auto table = open_table(path);
  ImportTable result;
  result.names = table->names();
  result.columns.resize(result.names.size());
  while (table->read(65536, result.columns) > 0) {
  }
  result.source = path.string();
  result.format = table->format();
  result.names_from_file = true;
  return {std::move(result)};
}

}  // namespace

std::vector<ImportTable> read_foreign(const std::filesystem::path& path, const TextLayout& layout) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw BadData(fmt::format("{}: does not exist; is the path right?", path.string()));
  }
  if (std::filesystem::is_directory(path, error)) {
    throw BadData(fmt::format("{}: is a folder; a file was expected (of a ROS 2 bag, its .db3 file)", path.string()));
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
  if (head.starts_with("MATLAB") || extension == ".mat") return read_mat_file(path);
  if (head.starts_with("\x89HDF\r\n\x1a\n")) return read_hdf5_columns(path);
  if (head.starts_with("\x1f\x8b")) {
    throw BadData(fmt::format("{}: is compressed; unpack it first: gunzip -k {}", path.string(), path.string()));
  }
  if (head.starts_with("PK\x03\x04")) {
    throw BadData(fmt::format(
        "{}: is a zip archive (.jpk-force files are ones): export the curve as text, or unpack it", path.string()));
  }
  return {read_text_table(path, layout)};
}

}  // namespace touchstone::importing
