#include "experiments/rows.h"

#include <fmt/format.h>

#include <stdexcept>

namespace touchstone::experiments {
using report::Table;

Table table_of(const Rows& rows, std::string caption, std::size_t text_columns) {
  if (rows.empty()) throw std::invalid_argument("a table needs the names of its columns");
  Table table;
  table.caption = std::move(caption);
  table.columns = rows.front();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].size() != table.columns.size()) {
      throw std::invalid_argument(
          fmt::format("row {} has {} cells for {} columns", i, rows[i].size(), table.columns.size()));
    }
    Table::Row row;
    for (std::size_t c = 0; c < rows[i].size(); ++c)
      row.cells.push_back({rows[i][c], c >= text_columns, report::Tone::neutral});
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace touchstone::experiments
