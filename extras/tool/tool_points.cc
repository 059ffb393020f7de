#include "tool_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/units.h"
#include "harness/recording/column.h"
#include "harness/recording/table_sink.h"
#include "harness/recording/table_source.h"

namespace touchstone::tool {
namespace {

constexpr std::array<std::string_view, 6> column_names{"x", "y", "z", "nx", "ny", "nz"};
constexpr const char* expected =
    "a tool of points has the columns x_m, y_m, z_m (or _mm, _cm, ...), nx, ny and nz (its outward normal)";

}  // namespace

PointShell load_point_shell(const std::filesystem::path& path) {
  const auto source = recording::open_table(path);
  const std::vector<std::string>& names = source->names();
  std::array<std::size_t, column_names.size()> column{};
  column.fill(names.size());
  std::array<double, 3> unit_m{};
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::string name = names[c].substr(0, names[c].find('_'));
    const auto* const known = std::ranges::find(column_names, name);
    const auto k = static_cast<std::size_t>(known - column_names.begin());
    const bool length = k < 3 && name.size() < names[c].size();
    if (known == column_names.end() || (k >= 3 && name != names[c]) || (k < 3 && !length) || column[k] != names.size())
      throw BadData(fmt::format("{}: column {} is not known here or stands twice; {}", source->name_place(c), names[c],
                                expected));
    column[k] = c;
    if (!length) continue;
    const std::string unit = names[c].substr(name.size() + 1);
    const auto factor = si_factor(Dimension::length, unit);
    if (!factor)
      throw BadData(fmt::format("{}: unit '{}' of column {} is not known; known: {}", source->name_place(c), unit,
                                names[c], known_units(Dimension::length)));
    unit_m[k] = *factor;
  }
  for (std::size_t k = 0; k < column_names.size(); ++k) {
    if (column[k] == names.size())
      throw BadData(fmt::format("{}: no column {}; {}", path.string(), column_names[k], expected));
  }
  std::vector<std::vector<double>> values(names.size());
  constexpr std::size_t rows = 8192;
  while (source->read(rows, values) > 0) {
  }
  PointShell shell;
  for (std::size_t i = 0; i < values[column[0]].size(); ++i) {
    std::array<double, column_names.size()> v{};
    for (std::size_t k = 0; k < column_names.size(); ++k) {
      v[k] = values[column[k]][i];
      if (!std::isfinite(v[k]))
        throw BadData(fmt::format("{}: {}; a finite number was expected", source->value_place(i, column[k]), v[k]));
    }
    const Vec3 outward(v[3], v[4], v[5]);
    const double length = outward.norm();
    if (!(length > 0.0) || !std::isfinite(length))
      throw BadData(fmt::format("{}: the normal ({}, {}, {}) has no direction", source->value_place(i, column[3]), v[3],
                                v[4], v[5]));
    shell.p_T_m.emplace_back(v[0] * unit_m[0], v[1] * unit_m[1], v[2] * unit_m[2]);
    shell.inward_T.emplace_back(-outward / length);
  }
  return shell;
}

void save_point_shell(const PointShell& shell, const std::filesystem::path& path) {
  std::vector<recording::Column> columns;
  for (std::size_t k = 0; k < column_names.size(); ++k) {
    const std::string name(column_names[k]);
    columns.push_back({recording::Quantity::x, k < 3 ? name + "_m" : name, k < 3 ? "m" : "1", recording::UnitScale()});
  }
  const auto sink = recording::create_table(path, columns);
  std::vector<std::vector<double>> values(columns.size());
  for (std::size_t i = 0; i < shell.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      values[static_cast<std::size_t>(k)].push_back(shell.p_T_m[i][k]);
      values[static_cast<std::size_t>(k) + 3].push_back(-shell.inward_T[i][k]);
    }
  }
  sink->write(values);
  sink->commit();
}

}  // namespace touchstone::tool
