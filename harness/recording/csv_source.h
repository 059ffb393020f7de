// CSV, plain or gzip: a header line of column names, then one line per sample. Values are separated by commas; a file
// whose header uses semicolons or tabs instead is read as such, with a note. Byte-order mark, CRLF line ends, blanks
// around values and quotes around names are tolerated. Values are read to the nearest double.
#pragma once

#include <filesystem>
#include <memory>

#include "harness/recording/table_source.h"

namespace touchstone::recording {

// Throws BadData for an empty file, a header that is not text, and, while reading, for any line that does not hold one
// number per column.
std::unique_ptr<TableSource> open_csv_source(const std::filesystem::path& path);

}  // namespace touchstone::recording
