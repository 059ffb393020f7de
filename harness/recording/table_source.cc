#include "harness/recording/table_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

#include "harness/base/error.h"
#include "harness/base/input_files.h"
#include "harness/recording/csv_source.h"
#include "harness/recording/hdf5_source.h"

namespace touchstone::recording {
namespace {

bool ends_with(const std::filesystem::path& path, std::string_view extension) {
  std::string name = path.filename().string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.size() > extension.size() && name.ends_with(extension);
}

void check_readable(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw BadData(fmt::format("{}: does not exist; is the path right?", path.string()));
  }
  if (std::filesystem::is_directory(status)) {
    throw BadData(fmt::format("{}: is a folder; a recording file was expected", path.string()));
  }
  if (!std::ifstream(path)) throw BadData(fmt::format("{}: cannot be opened for reading; may you?", path.string()));
}

bool holds_hdf5(const std::filesystem::path& path) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, 8> start{};
  std::ifstream in(path, std::ios::binary);
  return in.read(start.data(), start.size()) && std::string_view(start.data(), start.size()) == signature;
}

}  // namespace

TableFormat table_format(const std::filesystem::path& path) {
  if (ends_with(path, ".csv")) return TableFormat::csv;
  if (ends_with(path, ".csv.gz")) return TableFormat::csv_gzip;
  if (ends_with(path, ".h5") || ends_with(path, ".hdf5")) return TableFormat::hdf5;
  throw BadData(fmt::format(
      "{}: the extension does not say how the file is stored; name it .csv, .csv.gz, .h5 or .hdf5", path.string()));
}

std::unique_ptr<TableSource> open_table(const std::filesystem::path& path) {
  const TableFormat format = table_format(path);
  check_readable(path);
  note_input_file(path);
  if (format == TableFormat::hdf5) return open_hdf5_source(path);
  if (holds_hdf5(path)) {
    throw BadData(fmt::format("{}: is an HDF5 file with the name of a CSV file; rename it to .h5", path.string()));
  }
  return open_csv_source(path);
}

}  // namespace touchstone::recording
