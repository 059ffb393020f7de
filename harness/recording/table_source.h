// Rows of numbers under column names, as a file holds them, before anything is known about what they mean: what the CSV
// and HDF5 readers have in common. Reads in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace touchstone::recording {

class TableSource {
 public:
  virtual ~TableSource() = default;

  [[nodiscard]] virtual const std::vector<std::string>& names() const noexcept = 0;
  // Where the name of a column stands, and where one of its values does: "r.csv: line 7, column 2 (x_mm)".
  [[nodiscard]] virtual std::string name_place(std::size_t column) const = 0;
  [[nodiscard]] virtual std::string value_place(std::uint64_t row, std::size_t column) const = 0;
  // "line 7" or "sample 5": a row named within a sentence.
  [[nodiscard]] virtual std::string row_name(std::uint64_t row) const = 0;
  // Appends up to `max_rows` rows, one vector per column; returns how many, 0 at the end. Throws BadData.
  virtual std::size_t read(std::size_t max_rows, std::span<std::vector<double>> columns) = 0;
  // "CSV", "CSV, gzip" or "HDF5".
  [[nodiscard]] virtual std::string format() const = 0;
  // What was tolerated and should be known, one sentence each.
  [[nodiscard]] virtual const std::vector<std::string>& notes() const noexcept = 0;
};

// How a file is stored, by its name: .csv, .csv.gz, .h5, .hdf5. Throws BadData for another extension.
enum class TableFormat : std::uint8_t { csv, csv_gzip, hdf5 };
TableFormat table_format(const std::filesystem::path& path);

// Opens the reader that the extension asks for; throws BadData naming the file.
std::unique_ptr<TableSource> open_table(const std::filesystem::path& path);

}  // namespace touchstone::recording
