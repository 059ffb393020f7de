// The HDF5 half of TableSink: datasets that grow, shuffled, deflated and with a Fletcher-32 checksum on every chunk;
// the file's own structures are checksummed too (see hdf5_source.h for the layout). Throws BadData naming the file if
// it cannot be written.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "harness/recording/table_sink.h"

namespace touchstone::recording {

std::unique_ptr<TableSink> create_hdf5_sink(const std::filesystem::path& path, const std::vector<Column>& columns);

}  // namespace touchstone::recording
