#include "guess_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <set>
#include <string_view>
#include <tuple>

#include "foreign_unit.h"

namespace touchstone::importing {
namespace {

std::string listed(const std::vector<ImportTable>& tables, const std::vector<const NamedColumn*>& columns) {
  std::string list;
  constexpr std::size_t most = 6;
  for (std::size_t i = 0; i < columns.size() && i < most; ++i) {
    list += (list.empty() ? "" : ", ") + said_of(tables, columns[i]->table, columns[i]->column);
  }
  return columns.size() > most ? list + fmt::format(" and {} more", columns.size() - most) : list;
}

// x, y, z of the k-th component of a vector that has `count`, and which quantity it is then.
void resolve_component(ColumnName& name, unsigned k, std::size_t count) {
  const Quantity was = name.quantities.front();
  const bool six = count == 6, seven = count == 7;
  const auto set = [&](Quantity quantity, unsigned axis) {
    name.quantities = {quantity};
    name.axis = "xyzw"[axis];
  };
  constexpr std::size_t of_quaternion = 4;
  if (was == Quantity::angle) {
    name.quantities = {Quantity::other};  // several joints, but for four that may be a quaternion: the numbers tell
    if (count == of_quaternion) name.quantities.clear();
  } else if (count == 3 && (was == Quantity::position || was == Quantity::force || was == Quantity::torque)) {
    set(was, k);
  } else if (six && (was == Quantity::force || was == Quantity::wrench)) {
    set(k < 3 ? Quantity::force : Quantity::torque, k % 3);
    // Universal Robots' guide says that its TCP force is a wrench.
    const bool known = was == Quantity::wrench || name.frame.find("actual tcp") != std::string::npos;
    if (k >= 3 && !known) name.doubt = "of six forces the last three may be torques, or those of a second sensor";
  } else if ((six || seven) && was == Quantity::pose && k < 3) {
    set(Quantity::position, k);
  } else if (was == Quantity::time || was == Quantity::count) {
    return;
  } else if (was == Quantity::quaternion || was == Quantity::pose) {
    name.quantities.clear();  // its order is not in the names
  } else {
    name.quantities = {Quantity::other};
  }
}

// force_0 to force_5: as many of one frame as the numbers count, from 0 or from 1.
void resolve_numbers(std::vector<NamedColumn>& columns, const std::vector<ImportTable>& tables) {
  std::set<std::size_t> efforts;  // tables with such columns
  for (std::size_t t = 0; t < tables.size(); ++t) {
    for (const std::string& name : tables[t].names) {
      if (name.find("effort") != std::string::npos) efforts.insert(t);
    }
  }
  std::map<std::tuple<std::size_t, Quantity, std::string>, std::vector<NamedColumn*>> vectors;
  for (NamedColumn& column : columns) {
    if (!column.name.index || column.name.quantities.size() != 1) continue;
    vectors[{column.table, column.name.quantities.front(), column.name.frame}].push_back(&column);
  }
  for (auto& [key, members] : vectors) {
    // Positions beside efforts are those of joints (sensor_msgs/JointState).
    const auto& [table, quantity, frame] = key;
    const bool joints = quantity == Quantity::position && efforts.contains(table);
    for (NamedColumn* member : members) {
      if (joints) member->name.quantities = {Quantity::other};
    }
    if (joints) continue;
    std::set<unsigned> numbers;
    for (const NamedColumn* member : members) numbers.insert(*member->name.index);
    const unsigned first = *numbers.begin();
    const bool whole = first <= 1 && numbers.size() == members.size() &&
                       *numbers.rbegin() - first + 1 == static_cast<unsigned>(members.size());
    for (NamedColumn* member : members) {
      const unsigned k = *member->name.index - first;
      if (whole && members.size() > 1) resolve_component(member->name, k, members.size());
    }
  }
}

bool any_of(const std::vector<NamedColumn>& columns, Quantity quantity, bool with_axis) {
  return std::ranges::any_of(columns, [&](const NamedColumn& c) {
    return c.name.is(quantity) && (!with_axis || (c.name.axis != 0 && c.name.axis != 'n'));
  });
}

// q0 beside qx, qy, qz is the real part (NDI's trackers, many papers).
void resolve_q0(std::vector<NamedColumn>& columns) {
  const bool vector = any_of(columns, Quantity::quaternion, true);
  const bool real = std::ranges::any_of(
      columns, [](const NamedColumn& c) { return c.name.is(Quantity::quaternion) && c.name.axis == 'w'; });
  for (NamedColumn& column : columns) {
    if (!vector || real || !column.name.is(Quantity::angle) || column.name.index != 0U) continue;
    column.name.quantities = {Quantity::quaternion};
    column.name.axis = 'w';
  }
}

void resolve_open_names(std::vector<NamedColumn>& columns) {
  const bool forces = any_of(columns, Quantity::force, true), positions = any_of(columns, Quantity::position, true);
  const bool orientation = any_of(columns, Quantity::quaternion, true);
  const bool joint = any_of(columns, Quantity::torque, false) && !forces && !positions;
  const bool pressed = any_of(columns, Quantity::force, false);
  for (NamedColumn& column : columns) {
    ColumnName& name = column.name;
    if (name.may_be(Quantity::torque) && name.may_be(Quantity::position)) {
      const bool torque = forces && (!orientation || positions), translation = orientation && !forces && !positions;
      if (torque) name.quantities = {Quantity::torque};
      if (translation) name.quantities = {Quantity::position};
      if (!torque && !translation) name.doubt = "it may be a torque or a translation";
    } else if (name.may_be(Quantity::force) && name.may_be(Quantity::torque)) {
      name.doubt = "it may be a force or a torque";
    } else if (name.may_be(Quantity::position) && name.may_be(Quantity::angle)) {
      if (joint) name.quantities = {Quantity::angle};
      if (!joint && pressed) name.quantities = {Quantity::position};
      if (!joint && !pressed) name.doubt = "it may be a length or an angle";
    }
  }
}

// Sets of components in one table and one frame.
struct Group {
  std::size_t table = 0;
  std::string frame;
  std::map<char, std::vector<const NamedColumn*>> axes;

  [[nodiscard]] bool complete(bool quaternion) const {
    for (const char axis : std::string_view(quaternion ? "xyzw" : "xyz")) {
      if (!axes.contains(axis)) return false;
    }
    return true;
  }
};

// How surely a frame is the probe's own, as it was measured.
int preference(const std::string& frame, const std::string& near) {
  const auto has = [&](std::string_view word) {
    return (" " + frame + " ").find(fmt::format(" {} ", word)) != std::string::npos;
  };
  int points = !near.empty() && frame == near ? 4 : 0;
  for (const char* const word : {"tip", "tcp", "tool", "probe", "stylus", "eef", "ee", "hand", "effector"}) {
    if (has(word)) points += 2;
  }
  for (const char* const word : {"measured", "actual", "meas", "current"}) {
    if (has(word)) points += 1;
  }
  if (has("marker")) points -= 8;
  return points;
}

AxisChoice chosen(const Group& group, const std::vector<ImportTable>& tables) {
  AxisChoice choice;
  choice.frame = group.frame;
  for (const auto& [axis, members] : group.axes) {
    if (members.size() > 1) {
      choice.doubt = fmt::format("{} stand for the same", listed(tables, members));
      choice.axes.clear();
      return choice;
    }
    choice.axes[axis] = *members.front();
  }
  return choice;
}

}  // namespace

std::string said_of(const std::vector<ImportTable>& tables, std::size_t table, std::size_t column) {
  const ImportTable& of = tables[table];
  return fmt::format("'{}' (column {}{})", as_utf8(of.description(column)), column + 1,
                     tables.size() > 1 ? " of " + of.name : "");
}

std::vector<NamedColumn> named_columns(const std::vector<ImportTable>& tables) {
  std::vector<NamedColumn> columns;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    if (!tables[t].names_from_file) continue;
    for (std::size_t c = 0; c < tables[t].names.size(); ++c) {
      if (!tables[t].is_text(c)) columns.push_back({t, c, parse_column_name(tables[t].description(c))});
    }
  }
  resolve_q0(columns);
  resolve_numbers(columns, tables);
  resolve_open_names(columns);
  return columns;
}

AxisChoice choose_axes(const std::vector<NamedColumn>& columns, const std::vector<ImportTable>& tables,
                       Quantity quantity, const std::string& near) {
  std::map<std::pair<std::size_t, std::string>, Group> by_frame;
  std::vector<const NamedColumn*> scalars;
  // "Depth (V)" is no rival of "Depth (nm)".
  const auto has_sure_twin = [&](const NamedColumn& doubtful) {
    return std::ranges::any_of(columns, [&](const NamedColumn& other) {
      return other.name.is(quantity) && other.name.doubt.empty() && other.name.axis == doubtful.name.axis &&
             other.name.frame == doubtful.name.frame && other.table == doubtful.table;
    });
  };
  for (const NamedColumn& column : columns) {
    if (!column.name.is(quantity) || (!column.name.doubt.empty() && has_sure_twin(column))) continue;
    if (column.name.axis == 0 || column.name.axis == 'n') {
      scalars.push_back(&column);
      continue;
    }
    Group& group = by_frame[{column.table, column.name.frame}];
    group.table = column.table, group.frame = column.name.frame;
    group.axes[column.name.axis].push_back(&column);
  }
  const bool quaternion = quantity == Quantity::quaternion;
  std::vector<const Group*> groups;
  for (const auto& [key, group] : by_frame) {
    if (group.complete(quaternion)) groups.push_back(&group);
  }
  if (groups.empty() && quaternion) return {};
  if (groups.empty()) {
    for (const auto& [key, group] : by_frame) groups.push_back(&group);
  }
  if (groups.empty()) {
    if (scalars.empty()) return {};
    std::ranges::stable_sort(scalars, std::greater<>(),
                             [&](const NamedColumn* c) { return preference(c->name.frame, near); });
    if (scalars.size() > 1 && preference(scalars[0]->name.frame, near) == preference(scalars[1]->name.frame, near)) {
      return {{}, "", scalars.size(), fmt::format("{} are as likely", listed(tables, scalars))};
    }
    return {{{'0', *scalars.front()}}, scalars.front()->name.frame, scalars.size(), ""};
  }
  std::ranges::stable_sort(groups, std::greater<>(), [&](const Group* g) { return preference(g->frame, near); });
  if (groups.size() > 1 && preference(groups[0]->frame, near) == preference(groups[1]->frame, near)) {
    std::vector<const NamedColumn*> rivals;
    for (const Group* group : groups) rivals.push_back(group->axes.begin()->second.front());
    return {{}, "", groups.size(), fmt::format("{} are as likely: several stand for the same", listed(tables, rivals))};
  }
  AxisChoice choice = chosen(*groups.front(), tables);
  choice.among = groups.size();
  return choice;
}

bool have_norm_one(const ImportTable& table, const std::vector<std::size_t>& parts, bool& varies) {
  std::size_t rows = 0;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    double square = 0.0;
    for (const std::size_t c : parts) square += std::pow(table.columns[c][i], 2);
    for (const std::size_t c : parts) varies = varies || table.columns[c][i] != table.columns[c][0];
    if (std::isnan(square)) continue;
    constexpr double near = 1e-3;
    if (!(std::abs(square - 1.0) < near)) return false;
    ++rows;
  }
  return rows > 2;
}

std::string why_unused(const ColumnName& name) {
  if (name.quantities.empty()) return "nothing tells what it is";
  if (!name.doubt.empty()) return name.doubt;
  if (name.is(Quantity::count)) return "it counts rows";
  if (name.is(Quantity::other)) return "its name is of another quantity than a recording has";
  return "see what is to be decided, or another column stands for it";
}

bool names_angle_of_orientation(std::string_view name) {
  std::string small(name);
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::any_of(std::array<std::string_view, 5>{"roll", "pitch", "yaw", "rpy", "euler"},
                             [&](std::string_view word) { return small.find(word) != std::string::npos; });
}

std::vector<std::size_t> rotation_columns(const ImportTable& table) {
  std::vector<std::size_t> columns;
  for (int k = 0; k < 9; ++k) {
    const auto found = std::ranges::find(table.names, fmt::format("r{}{}", k / 3 + 1, k % 3 + 1));
    if (found == table.names.end()) return {};
    columns.push_back(static_cast<std::size_t>(found - table.names.begin()));
  }
  return columns;
}

std::string si_by_convention(const ImportTable& table) {
  const auto any_holds = [&](std::string_view part) {
    return std::ranges::any_of(table.names, [&](const std::string& n) { return n.find(part) != std::string::npos; });
  };
  // geometry_msgs names, as `topic echo` and PlotJuggler write them.
  for (const char* const part : {"header.stamp", "header/stamp", "wrench.force", "wrench/force", "pose.position",
                                 "pose/position", "transform.translation", "transform/translation"}) {
    if (any_holds(part)) return "REP 103 of ROS says";
  }
  if (table.format.starts_with("ROS")) return "REP 103 of ROS says";
  // "Real-Time Data Exchange (RTDE) Guide", Universal Robots: poses in m and rad, forces in N and N m.
  return any_holds("actual_TCP_") ? "Universal Robots' RTDE guide says" : "";
}

}  // namespace touchstone::importing
