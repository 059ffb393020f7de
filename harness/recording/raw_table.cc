#include "harness/recording/raw_table.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/recording/table_source.h"

namespace touchstone::recording {

RawTable::RawTable(const std::filesystem::path& path) : source_(path.string()) {
  const auto table = recording::open_table(path);
  names_ = table->names();
  columns_.resize(names_.size());
  while (table->read(65536, columns_) > 0) {
  }
  rows_ = columns_.empty() ? 0 : columns_.front().size();
  if (rows_ == 0)
    throw BadData(fmt::format(
        "{}: has a header and no samples; was the recording ended before it began, or is it another file?", source_));
}

std::string RawTable::names() const {
  std::string list;
  for (const auto& name : names_) list += (list.empty() ? "" : ", ") + name;
  return list;
}

bool RawTable::has(const std::string& name) const noexcept {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

const std::vector<double>& RawTable::column(const std::string& name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) throw BadData(fmt::format("{}: has no column {}; it has {}", source_, name, names()));
  return columns_[static_cast<std::size_t>(std::distance(names_.begin(), found))];
}

std::vector<double> RawTable::times_s(const std::string& unit_of_bare_t) const {
  std::vector<double> t;
  for (const auto& [unit, divisor] : {std::pair<std::string, double>{"s", 1.0}, {"ms", 1e3}, {"us", 1e6}}) {
    const auto name =
        has("t_" + unit) ? "t_" + unit : (unit == unit_of_bare_t && has("t") ? std::string("t") : std::string());
    if (name.empty()) continue;
    for (const double value : column(name)) t.push_back(value / divisor);
    break;
  }
  if (t.empty()) throw BadData(fmt::format("{}: has no time column (t_s, t_ms or t_us); it has {}", source_, names()));
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (!(t[i] > t[i - 1])) {
      throw BadData(
          fmt::format("{}: sample {}: time runs back or stands still: {:.9g} s after {:.9g} s; take the line out, or "
                      "sort the file if its lines are mixed up",
                      source_, i + 1, t[i], t[i - 1]));
    }
  }
  return t;
}

std::vector<Vec3> RawTable::vectors(const std::string& prefix, const std::vector<std::pair<std::string, double>>& units,
                                    bool bare_is_si) const {
  std::string tried;
  const auto read = [&](const std::string& suffix, double factor) -> std::vector<Vec3> {
    std::vector<Vec3> result;
    const std::string x = prefix + "x" + suffix, y = prefix + "y" + suffix, z = prefix + "z" + suffix;
    tried += (tried.empty() ? "" : ", ") + x;
    if (!has(x)) return result;
    const auto &cx = column(x), &cy = column(y), &cz = column(z);
    for (std::size_t i = 0; i < rows_; ++i) result.emplace_back(factor * cx[i], factor * cy[i], factor * cz[i]);
    return result;
  };
  for (const auto& [unit, factor] : units) {
    if (auto found = read("_" + unit, factor); !found.empty()) return found;
  }
  if (bare_is_si) {
    if (auto found = read("", 1.0); !found.empty()) return found;
  }
  throw BadData(fmt::format("{}: has none of the columns {}; it has {}", source_, tried, names()));
}

std::vector<Quat> RawTable::rotations() const {
  std::vector<Quat> result;
  const auto refuse = [&](std::size_t row, double off) {
    throw BadData(
        fmt::format("{}: sample {}: the orientation is off a rotation by {:.3g}; its columns are damaged or mixed up: "
                    "qw, qx, qy, qz must have length 1, and r11 ... r33 be a rotation row by row",
                    source_, row + 1, off));
  };
  if (has("qw")) {
    const auto &w = column("qw"), &x = column("qx"), &y = column("qy"), &z = column("qz");
    for (std::size_t i = 0; i < rows_; ++i) {
      const Quat q(w[i], x[i], y[i], z[i]);
      if (!(std::abs(q.norm() - 1.0) < 1e-2)) refuse(i, std::abs(q.norm() - 1.0));
      result.push_back(q.normalized());
    }
    return result;
  }
  if (!has("r11"))
    throw BadData(fmt::format("{}: has no orientation (qw, qx, qy, qz or r11 ... r33); it has {}", source_, names()));
  for (std::size_t i = 0; i < rows_; ++i) {
    Mat3 m;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) m(r, c) = column(fmt::format("r{}{}", r + 1, c + 1))[i];
    }
    const double off = (m * m.transpose() - Mat3::Identity()).norm();
    if (!(off < 1e-2) || m.determinant() < 0) refuse(i, off);
    result.push_back(Quat(m).normalized());
  }
  return result;
}

}  // namespace touchstone::recording
