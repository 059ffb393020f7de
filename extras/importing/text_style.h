// How the rows of a table of text are separated and how their numbers are written, found from the lines that go
// together.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "import_table.h"
#include "text_dialect.h"

namespace touchstone::importing {

struct TextRows {
  TextStyle style;
  std::size_t width = 0, first = 0;  // fields of a row; the first line of the longest run of them
  bool mixed = false;                // the rows hold text among the numbers
};

// In the styles that `layout` leaves open (`commas_alone`: only those separated by commas) the one in which the most
// numbers go together. Throws BadData where none makes rows, or where it is not certain whether a sign is decimal or
// groups thousands.
TextRows choose_text_style(const std::string& source, const std::vector<std::string_view>& lines,
                           const TextLayout& layout, bool commas_alone);

}  // namespace touchstone::importing
