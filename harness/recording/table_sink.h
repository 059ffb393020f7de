// Writes rows of numbers under column names to CSV or HDF5, in bounded memory. The file appears whole at commit(), or
// not at all. Numbers are written so that reading gives the same bits back.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "harness/recording/column.h"

namespace touchstone::recording {

class TableSink {
 public:
  virtual ~TableSink() = default;
  // One vector per column, all of one length, in the columns' units.
  virtual void write(std::span<const std::vector<double>> columns) = 0;
  // Puts the file in its place; throws BadData naming it when that fails.
  virtual void commit() = 0;
};

// The format by the extension (see table_format). Throws BadData when the file cannot be written.
std::unique_ptr<TableSink> create_table(const std::filesystem::path& path, const std::vector<Column>& columns);

}  // namespace touchstone::recording
