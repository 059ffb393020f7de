#include "harness/golden/comparison/column_file.h"

#include <fmt/format.h>

#include <future>

#include "harness/base/error.h"
#include "harness/base/units.h"
#include "harness/recording/column.h"
#include "harness/recording/table_source.h"

namespace touchstone::golden {
using recording::UnitScale;

namespace {

// The step time is a measurement of the machine, not of the renderer's answer.
constexpr std::string_view not_compared = "cost";

struct ParsedName {
  std::string quantity;
  UnitScale scale;
};

// Group completeness is not asked for here: a lacking column is the comparison's finding.
ParsedName parse_name(const recording::TableSource& table, std::size_t column) {
  const std::string& name = table.names()[column];
  const auto underscore = name.rfind('_');
  const std::string base = name.substr(0, underscore);
  const std::string unit = underscore == std::string::npos ? "" : name.substr(underscore + 1);
  for (const recording::QuantityInfo& info : recording::quantities()) {
    if (info.name != base) continue;
    if (base == not_compared) return {base, UnitScale()};
    if (info.dimension == Dimension::none && underscore == std::string::npos) return {base, UnitScale()};
    if (const auto factor = si_factor(info.dimension, unit)) return {base, UnitScale(*factor)};
    throw BadData(fmt::format("{}: column '{}': unknown unit '{}'; known: {}", table.name_place(column), name, unit,
                              known_units(info.dimension)));
  }
  std::string known;
  for (const recording::QuantityInfo& info : recording::quantities())
    known += fmt::format("{}{}", known.empty() ? "" : ", ", info.name);
  throw BadData(fmt::format("{}: unknown column '{}'; known quantities: {}, each with its unit, as in fx_N",
                            table.name_place(column), name, known));
}

}  // namespace

TrajectoryColumns load_columns(const std::filesystem::path& path) {
  const auto table = recording::open_table(path);
  std::vector<ParsedName> names;
  names.reserve(table->names().size());
  for (std::size_t c = 0; c < table->names().size(); ++c) names.push_back(parse_name(*table, c));
  std::vector<std::vector<double>> values(names.size());
  constexpr std::size_t block = 1 << 16;
  while (table->read(block, values) > 0) {
  }
  TrajectoryColumns set{path.string(), {}};
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (names[c].quantity == not_compared) continue;
    if (!names[c].scale.identity()) {
      for (double& value : values[c]) value = names[c].scale.to_si(value);
    }
    set.columns.push_back({names[c].quantity, std::move(values[c])});
  }
  return set;
}

std::pair<TrajectoryColumns, TrajectoryColumns> load_columns(const std::filesystem::path& expected,
                                                             const std::filesystem::path& obtained) {
  auto other = std::async(std::launch::async, [&] { return load_columns(obtained); });
  auto first = load_columns(expected);
  return {std::move(first), other.get()};
}

}  // namespace touchstone::golden
