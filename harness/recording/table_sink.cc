#include "harness/recording/table_sink.h"

#include "harness/recording/csv_sink.h"
#include "harness/recording/hdf5_sink.h"
#include "harness/recording/table_source.h"

namespace touchstone::recording {

std::unique_ptr<TableSink> create_table(const std::filesystem::path& path, const std::vector<Column>& columns) {
  const TableFormat format = table_format(path);
  if (format == TableFormat::hdf5) return create_hdf5_sink(path, columns);
  return create_csv_sink(path, columns, format == TableFormat::csv_gzip);
}

}  // namespace touchstone::recording
