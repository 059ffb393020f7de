// Which columns of a file make a position, a force, a torque or an orientation together, from their names alone: the
// components of one frame, each once. Where two sets stand for the same, or a name stays open, that is said and nothing
// is chosen.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "column_name.h"
#include "import_table.h"

namespace touchstone::importing {

struct NamedColumn {
  std::size_t table = 0, column = 0;
  ColumnName name;
};

// Every column of the tables, parsed; components that are counted (force_0 to force_5) and names that the others decide
// (tx beside fx is a torque, beside qw a translation) are resolved, or have a doubt.
std::vector<NamedColumn> named_columns(const std::vector<ImportTable>& tables);

struct AxisChoice {
  std::map<char, NamedColumn> axes;  // x, y, z (and w); or '0' alone: a quantity without an axis
  std::string frame;                 // of the set that was chosen among several
  std::size_t among = 1;             // how many sets there were
  std::string doubt;                 // empty, or why none was chosen
};

// `near`: the frame that was chosen for another quantity, which is preferred.
AxisChoice choose_axes(const std::vector<NamedColumn>& columns, const std::vector<ImportTable>& tables,
                       Quantity quantity, const std::string& near = "");

// "'X' (column 3)", with the table where there are several.
std::string said_of(const std::vector<ImportTable>& tables, std::size_t table, std::size_t column);

// Whether the squares of the columns `parts` add to 1 in every row, as those of a quaternion do; says whether any
// varies.
bool have_norm_one(const ImportTable& table, const std::vector<std::size_t>& parts, bool& varies);
// Why a column of this name is none of a recording's.
std::string why_unused(const ColumnName& name);
// roll, pitch, yaw, rpy, euler: conventions differ in the order of the turns and in the unit.
bool names_angle_of_orientation(std::string_view name);
// The columns r11, r12, ... r33 of a rotation, row by row; empty if there are not all.
std::vector<std::size_t> rotation_columns(const ImportTable& table);
// Whose convention says that columns without a unit are in SI: "REP 103 of ROS says"; empty if none does.
std::string si_by_convention(const ImportTable& table);

}  // namespace touchstone::importing
