// The columns that a recording may have, by name: quantity and unit, as in x_mm or fx_N. One catalogue for CSV headers
// and HDF5 dataset names. A column whose name or unit is not in it is an error that names it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/units.h"

namespace touchstone::recording {

enum class Quantity : std::uint8_t { t, x, y, z, qw, qx, qy, qz, fx, fy, fz, tx, ty, tz, px, py, pz, contact, cost };
inline constexpr std::size_t quantity_count = 19;

// Columns that only make sense together, all in one unit.
enum class ColumnGroup : std::uint8_t { time, position, orientation, force, torque, contact_point, contact, cost };
inline constexpr std::size_t group_count = 8;

struct QuantityInfo {
  Quantity quantity;
  std::string_view name;  // before the underscore
  ColumnGroup group;
  Dimension dimension;  // none: the column carries no unit
};
const std::array<QuantityInfo, quantity_count>& quantities();

// Conversion that rounds once: x mm is x / 1000 m, not x * 0.001 m, whose factor is rounded already.
class UnitScale {
 public:
  explicit UnitScale(double factor_to_si = 1.0);
  [[nodiscard]] double to_si(double value) const noexcept { return divides_ ? value / number_ : value * number_; }
  [[nodiscard]] double from_si(double value) const noexcept { return divides_ ? value * number_ : value / number_; }
  [[nodiscard]] bool identity() const noexcept { return number_ == 1.0; }

 private:
  double number_;
  bool divides_;
};

struct Column {
  Quantity quantity;
  std::string name;  // as the file has it: "x_mm"
  std::string unit;  // "mm"; "1" where the quantity has none
  UnitScale scale;
};

// The columns of one file, checked: no unknown name or unit, none twice, groups complete and in one unit.
class ColumnSet {
 public:
  // `place(i)` says where the name of column i stands, for messages: "r.csv: line 1, column 3".
  static ColumnSet parse(const std::vector<std::string>& names, const std::function<std::string(std::size_t)>& place);

  [[nodiscard]] bool has(ColumnGroup group) const noexcept;
  // The place of a quantity among the file's columns.
  [[nodiscard]] std::optional<std::size_t> find(Quantity quantity) const noexcept;
  [[nodiscard]] const std::vector<Column>& columns() const noexcept { return columns_; }

 private:
  std::vector<Column> columns_;
};

// The units that a file is written in.
struct ColumnUnits {
  std::string time = "s";
  std::string length = "m";
  std::string force = "N";
  std::string torque = "Nm";
};

// The columns of `groups` in the catalogue's order with their names in `units`; throws UsageError for an unknown unit.
std::vector<Column> make_columns(const std::vector<ColumnGroup>& groups, const ColumnUnits& units);

// "fx, fy, fz"
std::string group_members(ColumnGroup group);
// The names with units that a group may have: "fx_N, fy_N, fz_N (units: N, mN, kN)".
std::string describe_group(ColumnGroup group);

}  // namespace touchstone::recording
