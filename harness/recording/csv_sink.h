// The CSV half of TableSink: see table_sink.h for what a table is and when a file appears. Throws BadData naming the
// file if it cannot be written.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "harness/recording/table_sink.h"

namespace touchstone::recording {

std::unique_ptr<TableSink> create_csv_sink(const std::filesystem::path& path, const std::vector<Column>& columns,
                                           bool gzip);

}  // namespace touchstone::recording
