#include "map_units.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "column_name.h"
#include "foreign_unit.h"
#include "harness/base/error.h"

namespace touchstone::importing {

void check_unit_of_term(const ImportTable& table, std::size_t column, const ImportTerm& term, const std::string& result,
                        const std::string& map_source) {
  const auto underscore = result.find('_');
  if (!table.names_from_file || underscore == std::string::npos) return;
  const ColumnName name = parse_column_name(table.description(column));
  if (name.unit.empty()) return;
  constexpr auto quantities = std::to_array<std::string_view>({"s", "m", "N", "N.m", "rad"});
  for (const std::string_view si : quantities) {
    const auto from = foreign_unit_factor(name.unit, si), to = foreign_unit_factor(result.substr(underscore + 1), si);
    if (!from || !to) continue;
    const double wanted = *from / *to;
    constexpr double rounding = 1e-6;
    if (std::abs(std::abs(term.scale) - wanted) <= rounding * wanted) return;
    throw BadData(fmt::format(
        "{}: column {} is '{}', from whose unit {} the scale to {} is {:.9g}, and not {:.9g} as the map {} has it: put "
        "that scale, or, if the file names the wrong unit, name the columns in /table/names",
        table.source, column + 1, as_utf8(table.description(column)), as_utf8(name.unit), result, wanted,
        std::abs(term.scale), map_source));
  }
}

}  // namespace touchstone::importing
