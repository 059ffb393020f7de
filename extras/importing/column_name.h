// The grammar of column names: what loggers, robots and testing machines call a column, parsed into quantity, axis,
// frame, index and unit, whatever the order, case and separators: F_x(N), ForceX, force.x, /ft/wrench/force/x, Fx [mN],
// x-position / mm, actual_TCP_force_0.
//
//   name  = word { separator word } [ unit ]      separators: _ . / : - blank, small to capital, letter to digit
//   word  = quantity | axis | quantity axis | axis quantity | number | frame
//   unit  = ( text ) | [ text ] | { text } | "/ " text | ", " text | the last word, if it is a unit of the quantity
//
// A name can stay open: `tx` is a torque or a translation. Then `quantities` has both, and the other columns decide.
// What is neither known as a quantity nor as a frame makes a bare axis no position: gyro_x is none.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::importing {

// wrench: force and torque by number; pose: position and orientation by number; other: known to be none of these, as a
// velocity or a commanded force is.
enum class Quantity { time, count, position, force, torque, quaternion, angle, wrench, pose, other };

struct ColumnName {
  std::vector<Quantity> quantities;  // empty: nothing in the name tells
  char axis = 0;                     // x, y, z, w; n: along the surface's normal; 0: none named
  std::optional<unsigned> index;     // of a vector's component, as the name counts
  std::string frame;                 // the other words, joined by blanks: "actual tcp"
  std::string unit;                  // as written; empty: none
  std::optional<double> factor;      // from `unit` to SI; none where there is no unit, or none that fits
  std::string doubt;                 // why it must not be used as it is: "lbx is no unit that is known"

  [[nodiscard]] bool is(Quantity quantity) const { return quantities.size() == 1 && quantities.front() == quantity; }
  [[nodiscard]] bool may_be(Quantity quantity) const;
};

ColumnName parse_column_name(std::string_view name);
// Whether of more than half of them the quantity is known, or that it is another.
bool most_are_column_names(const std::vector<std::string_view>& names);
// "m", "N", "N.m", "s", "rad"; empty for those without.
std::string_view si_unit(Quantity quantity);

}  // namespace touchstone::importing
