// A table as rows of text, the first of them the columns' names: for console and page.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/report/page.h"

namespace touchstone::experiments {

using Rows = std::vector<std::vector<std::string>>;

// The first `text_columns` are words, the others numbers. Throws std::invalid_argument for a row that is shorter or
// longer than the first, or no row at all.
report::Table table_of(const Rows& rows, std::string caption, std::size_t text_columns = 1);

}  // namespace touchstone::experiments
