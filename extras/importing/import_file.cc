#include "import_file.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/vec.h"
#include "harness/recording/ati_calibration.h"
#include "map_units.h"
#include "time_series.h"

namespace touchstone::importing {
namespace {

using Series = std::vector<double>;

// The main file's tables and those of `files`, with columns by name on the main clock.
class Sources {
 public:
  Sources(const std::filesystem::path& path, const ImportMap& map) : map_(map) {
    tables_ = read_foreign(path, map.layout);
    format_ = tables_.front().format;
    if (!map.stack.empty()) stack();
    main_rows_ = tables_.front().rows();
    for (const ImportFile& file : map.files) {
      auto read = read_foreign(path.parent_path() / file.file, file.layout);
      read.front().name = file.name;
      if (file.time) clocks_.emplace_back(file.name, *file.time);
      tables_.push_back(std::move(read.front()));
    }
  }

  [[nodiscard]] const std::string& format() const { return format_; }
  [[nodiscard]] std::size_t rows() const { return main_rows_; }
  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::string> all;
    for (const ImportTable& table : tables_) all.insert(all.end(), table.notes.begin(), table.notes.end());
    return all;
  }

  // The table whose rows the result has: that of the time.
  void choose_main(const std::string& column) {
    main_ = &table_of(column).first;
    main_rows_ = main_->rows();
  }
  void set_clock(Series t_s) { main_clock_ = std::move(t_s); }

  // Values of a column on the main table's rows. `result`: the column that they become, if its unit is to be the same.
  [[nodiscard]] Series values(const ImportTerm& term, const std::string& result = "") const {
    const auto [table, column] = table_of(term.column);
    check_unit_of_term(table, column, term, result, map_.source);
    Series own = table.columns[column];
    for (double& v : own) v *= term.scale;
    const ImportTable& main = main_ == nullptr ? tables_.front() : *main_;
    if (&table == &main) {
      if (!map_.rows_at.empty() && !main_clock_.empty()) fill_missing(main_clock_, own);
      return own;
    }
    const Series clock = clock_of(table);
    if (clock.empty() || main_clock_.empty()) {
      if (own.size() == main_rows_) return own;
      throw BadData(
          fmt::format("{}: has {} rows where {} has {}; give its clock (\"time\") in the map {} to join them "
                      "by time",
                      table.source + (table.name.empty() ? "" : " (" + table.name + ")"), own.size(), main.source,
                      main_rows_, map_.source));
    }
    return interpolated(table, clock, own);
  }

  [[nodiscard]] std::string source() const { return tables_.front().source; }
  // As the file has it, on its own table's rows.
  [[nodiscard]] const Series& as_read(const std::string& column) const {
    const auto [table, number] = table_of(column);
    return table.columns[number];
  }

 private:
  using Place = std::pair<const ImportTable&, std::size_t>;

  // A name that several columns have is refused: the first is not more likely than the others.
  [[nodiscard]] static std::optional<std::size_t> find_in(const ImportTable& table, const std::string& name) {
    const auto found = std::ranges::find(table.names, name);
    if (std::ranges::count(table.names, name) > 1) {
      std::string numbers;
      for (std::size_t c = 0; c < table.names.size(); ++c) {
        if (table.names[c] == name) numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", c + 1);
      }
      throw BadData(fmt::format("{}: '{}' stands for columns {}: give the number of one in the map", table.source, name,
                                numbers));
    }
    if (found != table.names.end()) {
      const auto c = static_cast<std::size_t>(found - table.names.begin());
      if (table.is_text(c)) throw BadData(fmt::format("{}: column {} ({}) holds text", table.source, c + 1, name));
      return c;
    }
    std::size_t number = 0;
    const auto [end, status] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (status == std::errc{} && end == name.data() + name.size() && number >= 1 && number <= table.names.size()) {
      if (table.is_text(number - 1)) {
        throw BadData(fmt::format("{}: column {} ({}) holds text", table.source, number, table.names[number - 1]));
      }
      return number - 1;
    }
    return std::nullopt;
  }

  [[nodiscard]] Place table_of(const std::string& name) const {
    const auto colon = name.rfind(':');
    if (colon != std::string::npos) {
      for (const ImportTable& table : tables_) {
        if (table.name != name.substr(0, colon) || table.name.empty()) continue;
        if (const auto column = find_in(table, name.substr(colon + 1))) return {table, *column};
      }
    }
    for (const ImportTable& table : tables_) {
      if (const auto column = find_in(table, name)) return {table, *column};
    }
    std::string list;
    for (const ImportTable& table : tables_) {
      for (const std::string& n : table.names) {
        list += fmt::format("{}{}{}", list.empty() ? "" : ", ", table.name.empty() ? "" : table.name + ":", n);
      }
    }
    throw BadData(
        fmt::format("{}: has no column '{}', which the map {} asks for; it has {}", source(), name, map_.source, list));
  }

  [[nodiscard]] Series clock_of(const ImportTable& table) const {
    for (const auto& [name, term] : clocks_) {
      if (name != table.name) continue;
      const auto column = find_in(table, term.column);
      if (!column) throw BadData(fmt::format("{}: has no column '{}' for its time", table.source, term.column));
      Series t = table.columns[*column];
      for (double& v : t) v *= term.scale;
      return t;
    }
    // Topics of a bag have a clock of their own.
    const auto own = find_in(table, "t");
    return own && table.format.starts_with("ROS") ? table.columns[*own] : Series{};
  }

  [[nodiscard]] Series interpolated(const ImportTable& table, const Series& clock, const Series& own) const {
    for (std::size_t i = 1; i < clock.size(); ++i) {
      if (!(clock[i] > clock[i - 1])) {
        throw BadData(fmt::format("{}: row {}: time does not increase: {:.9g} s after {:.9g} s", table.source, i + 1,
                                  clock[i], clock[i - 1]));
      }
    }
    return interpolated_at(clock, own, main_clock_);  // rows outside of it are left out
  }

  // Parts that stand side by side go below one another, with the number of the part as `segment`.
  void stack() {
    ImportTable& table = tables_.front();
    ImportTable stacked;
    stacked.source = table.source, stacked.format = table.format, stacked.notes = table.notes;
    for (const auto& [name, column] : map_.stack.front().columns) stacked.names.push_back(name);
    stacked.names.emplace_back("segment");
    stacked.columns.resize(stacked.names.size());
    for (std::size_t p = 0; p < map_.stack.size(); ++p) {
      const ImportMap::Part& part = map_.stack[p];
      std::size_t padding = 0;
      if (!part.padded.empty()) {
        const Series& values = table.columns[table_of(part.columns.at(part.padded)).second];
        while (padding + 1 < values.size() && values[padding + 1] == values.front()) ++padding;
      }
      std::size_t to = 0;
      for (const auto& [name, column] : part.columns) {
        const auto [owner, number] = table_of(column);
        if (&owner != &table) {
          throw BadData(fmt::format("{}: /stack of the map {}: '{}' is no column of the first table but of '{}'",
                                    table.source, map_.source, column, owner.name));
        }
        Series values = table.columns[number];
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(padding));
        if (part.reverse) std::ranges::reverse(values);
        stacked.columns[to].insert(stacked.columns[to].end(), values.begin(), values.end());
        ++to;
      }
      stacked.columns[to].insert(stacked.columns[to].end(), table.rows() - padding, static_cast<double>(p));
      if (padding > 0) {
        stacked.notes.push_back(
            fmt::format("{}: {} rows at the beginning of part {} of the stack repeat one value of "
                        "'{}' and are left out as padding",
                        table.source, padding, p + 1, part.padded));
      }
    }
    table = std::move(stacked);
  }

  const ImportMap& map_;
  std::vector<ImportTable> tables_;
  std::vector<std::pair<std::string, ImportTerm>> clocks_;
  const ImportTable* main_ = nullptr;
  std::size_t main_rows_ = 0;
  Series main_clock_;
  std::string format_;
};

Series sum_of(const Sources& sources, const ImportColumn& column) {
  if (column.row_rate_Hz) {
    Series t(sources.rows());
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = static_cast<double>(i) / *column.row_rate_Hz + column.offset;
    return t;
  }
  Series sum(sources.rows(), column.integrate ? 0.0 : column.offset);
  for (const ImportTerm& term : column.terms) {
    const Series values = sources.values(term, column.integrate ? "" : column.name);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
  }
  return sum;
}

void integrate(Series& rate, const Series& t_s, double start) {
  double value = start, before = rate.empty() ? 0.0 : rate.front();
  for (std::size_t i = 0; i < rate.size(); ++i) {
    if (i > 0) value += 0.5 * (before + rate[i]) * (t_s[i] - t_s[i - 1]);
    before = rate[i];
    rate[i] = value;
  }
}

std::vector<Quat> orientations(const Sources& sources, const ImportMap& map) {
  std::vector<Series> parts;
  const auto& names = !map.rotation_rows.empty() ? map.rotation_rows
                      : !map.quaternion.empty()  ? map.quaternion
                                                 : map.euler;
  for (const std::string& name : names) parts.push_back(sources.values({name, 1.0}));
  std::vector<Quat> q;
  for (std::size_t i = 0; !parts.empty() && i < sources.rows(); ++i) {
    Quat one = Quat::Identity();
    double off = 0.0;
    if (parts.size() == 9) {
      Mat3 m;
      for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = parts[static_cast<std::size_t>(k)][i];
      if (m.allFinite()) {
        // The nearest rotation: files round, and interpolation shortens.
        const Eigen::JacobiSVD<Mat3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Mat3 nearest = svd.matrixU() * svd.matrixV().transpose();
        off = nearest.determinant() < 0.0 ? 2.0 : (m - nearest).norm();
        one = Quat(nearest);
      }
    } else if (parts.size() == 4) {
      one = Quat(parts[0][i], parts[1][i], parts[2][i], parts[3][i]);
      off = std::abs(one.norm() - 1.0);
      one.normalize();
    } else {
      for (std::size_t a = 0; a < 3; ++a) {
        const Vec3 axis = Vec3::Unit(map.euler_order[a] - 'x');
        one = one * Quat(Eigen::AngleAxisd(parts[a][i] * map.euler_scale, axis));
      }
    }
    constexpr double most_off = 0.05;
    if (off > most_off) {
      throw BadData(
          fmt::format("{}: row {}: the orientation is off a rotation by {:.3g}: are its columns, or their "
                      "order in the map {}, right?",
                      sources.source(), i + 1, off, map.source));
    }
    if (!q.empty() && q.back().dot(one) < 0.0) one.coeffs() = -one.coeffs();
    q.push_back(one);
  }
  return q;
}

std::vector<double>* column_of(Imported& imported, std::string_view prefix) {
  for (std::size_t c = 0; c < imported.names.size(); ++c) {
    if (imported.names[c].starts_with(prefix)) return &imported.columns[c];
  }
  return nullptr;
}

// Force and torque as the map wants them read.
void turn_forces(Imported& imported, const ImportMap& map, const std::vector<Quat>& q, const std::string& source) {
  for (const auto& [x, y, z] : {std::tuple{"fx_", "fy_", "fz_"}, std::tuple{"tx_", "ty_", "tz_"}}) {
    auto *cx = column_of(imported, x), *cy = column_of(imported, y), *cz = column_of(imported, z);
    if (cx == nullptr || cy == nullptr || cz == nullptr) continue;
    if (map.force_frame != ForceFrameReading::object && q.empty()) {
      throw BadData(
          fmt::format("{}: force_frame needs an orientation (quaternion, rotation_rows or euler) in the map {}", source,
                      map.source));
    }
    for (std::size_t i = 0; i < cx->size(); ++i) {
      Vec3 f = map.force_sign * Vec3((*cx)[i], (*cy)[i], (*cz)[i]);
      if (map.force_frame == ForceFrameReading::sensor) f = q[i] * f;
      if (map.force_frame == ForceFrameReading::inverse) f = q[i].conjugate() * f;
      if (map.force_frame == ForceFrameReading::transposed) f = q[i] * (q[i] * f);
      (*cx)[i] = f.x(), (*cy)[i] = f.y(), (*cz)[i] = f.z();
    }
  }
}

// Between which rows of the file a row's shifted force lies: `row` and the next, `share` of the way.
struct Between {
  std::size_t row = 0;
  double share = 0.0;
  bool there = false;  // false: the file has nothing at that time
};

std::vector<Between> shifted_rows(const Series& t, double shift_s) {
  std::vector<Between> rows(t.size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double at = t[i] - shift_s;
    if (t.size() < 2 || at < t.front() || at > t.back()) continue;
    while (k + 2 < t.size() && t[k + 1] < at) ++k;
    rows[i] = {k, (at - t[k]) / (t[k + 1] - t[k]), true};
  }
  return rows;
}

// Force at time t is what the file has at t - shift, and so is what the sensor said of it.
void shift_forces(Imported& imported, double shift_s, std::vector<unsigned>& flags) {
  const auto* const clock = column_of(imported, "t_s");
  if (clock == nullptr || shift_s == 0.0) return;
  const std::vector<Between> from = shifted_rows(*clock, shift_s);
  for (const char* const name : {"fx_", "fy_", "fz_", "tx_", "ty_", "tz_"}) {
    auto* const column = column_of(imported, name);
    if (column == nullptr) continue;
    const Series old = *column;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const auto& [row, share, there] = from[i];
      (*column)[i] = there ? old[row] + share * (old[row + 1] - old[row]) : std::numeric_limits<double>::quiet_NaN();
    }
  }
  const std::vector<unsigned> old = flags;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const auto& [row, share, there] = from[i];
    flags[i] = there ? (share < 1.0 ? old[row] : 0U) | (share > 0.0 ? old[row + 1] : 0U) : 0U;
  }
}

// What the sensor said of its samples: rows whose forces are none as flags of `SampleFlags`, by row; empty where all
// are sound. Refuses, or notes, as the map wants it.
std::vector<unsigned> sensor_flags(Imported& imported, const ImportMap& map, const Sources& sources) {
  if (!map.status) return {};
  const Series words = sources.values({map.status->column, 1.0});
  const auto* const t = column_of(imported, "t_s");
  std::vector<unsigned> flags(words.size(), 0);
  struct Said {
    std::size_t samples = 0, first = 0, last = 0;
    bool bad = false;
  };
  std::map<std::string, Said> all;
  std::size_t bad_samples = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    constexpr double most = 4294967295.0;
    if (!(words[i] >= 0.0) || !(words[i] <= most) || words[i] != std::floor(words[i])) {
      throw BadData(
          fmt::format("{}: row {}: the status '{}' is {:g}: a whole number of 32 bits was expected; is this its "
                      "column in the map {}?",
                      sources.source(), i + 1, map.status->column, words[i], map.source));
    }
    const SensorStatus status = read_sensor_status(map.status->device, static_cast<std::uint32_t>(words[i]));
    if (status.beyond_range) flags[i] |= recording::sample_saturated;
    if (status.faulty) flags[i] |= recording::sample_device_error;
    bad_samples += flags[i] != 0 ? 1 : 0;
    if (status.text.empty()) continue;
    Said& said = all[status.text];
    if (said.samples++ == 0) said.first = i;
    said.last = i, said.bad = flags[i] != 0;
  }
  const auto place = [&](std::size_t i) {
    return t != nullptr ? fmt::format("row {} ({:.6g} s)", i + 1, (*t)[i]) : fmt::format("row {}", i + 1);
  };
  std::string bad_text;
  for (const auto& [text, said] : all) {
    const std::string line = fmt::format("the sensor says '{}' of {} of {} samples, the first in {}, the last in {}",
                                         text, said.samples, words.size(), place(said.first), place(said.last));
    if (!said.bad || map.status->bad_samples != BadSamples::refuse) {
      imported.notes.push_back(fmt::format("{}: {}", sources.source(), line));
    } else {
      bad_text += (bad_text.empty() ? "" : "; ") + line;
    }
  }
  if (!bad_text.empty()) {
    throw BadData(
        fmt::format("{}: {}: forces there are too small or none; \"bad_samples\": \"leave out\" in /status of "
                    "the map {} leaves them out, \"keep\" keeps them",
                    sources.source(), bad_text, map.source));
  }
  if (bad_samples == 0) flags.clear();
  return flags;
}

// Rows outside of the wanted ones, and rows in which something is missing.
void select_rows(Imported& imported, const ImportMap& map, const Sources& sources, const std::vector<unsigned>& flags) {
  std::vector<char> keep(sources.rows(), 1);
  if (map.status && map.status->bad_samples == BadSamples::leave_out && !flags.empty()) {
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = flags[i] == 0 ? 1 : 0;
    imported.notes.push_back(fmt::format("{}: {} rows left out: the sensor was saturated or faulty there",
                                         sources.source(), std::ranges::count(keep, 0)));
  }
  if (!map.rows_at.empty()) {
    const Series& at = sources.as_read(map.rows_at);
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = keep[i] != 0 && i < at.size() && std::isfinite(at[i]);
  }
  for (const auto& [name, wanted] : map.where) {
    const Series values = sources.values({name, 1.0});
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = keep[i] != 0 && values[i] == wanted ? 1 : 0;
  }
  const auto* const t = column_of(imported, "t_s");
  std::size_t missing = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (t != nullptr && ((map.from_s && (*t)[i] < *map.from_s) || (map.to_s && (*t)[i] > *map.to_s))) keep[i] = 0;
    const bool whole = std::ranges::all_of(imported.columns, [&](const Series& c) { return std::isfinite(c[i]); });
    if (keep[i] != 0 && !whole) keep[i] = 0, ++missing;
  }
  for (Series& column : imported.columns) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (keep[i] != 0) column[to++] = column[i];
    }
    column.resize(to);
  }
  if (missing > 0) {
    imported.notes.push_back(
        fmt::format("{}: {} rows left out: a value is missing there, or one of the clocks has not "
                    "begun or has ended",
                    sources.source(), missing));
  }
  if (imported.columns.front().empty()) {
    throw BadData(fmt::format("{}: no row is left of {} (rows in the map {}; clocks that do not overlap)",
                              sources.source(), keep.size(), map.source));
  }
}

// The order of recordings: time, position, force, orientation, torque, then the rest.
int rank_of(const std::string& name) {
  constexpr std::array<std::string_view, 5> order{"t_s", "x_", "y_", "z_", "f"};
  for (std::size_t r = 0; r < order.size(); ++r) {
    if (name.starts_with(order[r])) return static_cast<int>(r);
  }
  return name.starts_with("t") ? 100 : 50;
}

}  // namespace

Imported import_file(const std::filesystem::path& path, const ImportMap& map) {
  Sources sources(path, map);
  Imported imported;
  imported.format = sources.format();
  std::vector<ImportColumn> columns = map.columns;
  std::ranges::stable_sort(columns, {}, [](const ImportColumn& c) { return rank_of(c.name); });
  const auto clock = std::ranges::find(columns, std::string("t_s"), &ImportColumn::name);
  if (clock != columns.end() && !clock->terms.empty()) sources.choose_main(clock->terms.front().column);
  Series t_s;
  if (clock != columns.end()) sources.set_clock(t_s = sum_of(sources, *clock));
  for (const ImportColumn& column : columns) {
    Series values = sum_of(sources, column);
    if (column.integrate) {
      if (t_s.empty()) throw BadData(fmt::format("{}: /columns/{}: an integral needs t_s", map.source, column.name));
      integrate(values, t_s, column.offset);
    }
    imported.names.push_back(column.name);
    imported.columns.push_back(std::move(values));
  }
  const auto q = orientations(sources, map);
  turn_forces(imported, map, q, sources.source());
  if (!q.empty()) {
    for (const char* const name : {"qw", "qx", "qy", "qz"}) imported.names.emplace_back(name);
    for (const int k : {3, 0, 1, 2}) {  // Eigen keeps x, y, z, w
      Series values;
      values.reserve(q.size());
      for (const Quat& one : q) values.push_back(one.coeffs()[k]);
      imported.columns.push_back(std::move(values));
    }
  }
  imported.notes = sources.notes();
  auto flags = sensor_flags(imported, map, sources);
  shift_forces(imported, map.shift_force_s, flags);
  // A recording has no place for them; a table of wrenches alone, which `touchstone acquire` takes, has.
  if (!flags.empty() && map.status->bad_samples == BadSamples::keep && column_of(imported, "x_") == nullptr) {
    imported.names.emplace_back("flags");
    imported.columns.emplace_back(flags.begin(), flags.end());
  }
  select_rows(imported, map, sources, flags);
  // Clocks of the day lose digits: a recording begins at zero.
  if (auto* const t = column_of(imported, "t_s"); t != nullptr && t->front() != 0.0) {
    imported.notes.push_back(fmt::format("{}: time counts from {:.9g} s of the file", sources.source(), t->front()));
    const double start = t->front();
    for (double& v : *t) v -= start;
  }
  return imported;
}

}  // namespace touchstone::importing
