#include "harness/golden/comparison/trajectory_columns.h"

#include <algorithm>

namespace touchstone::golden {
namespace {

constexpr std::array<ComparedQuantity, 7> groups{{
    {Quantity::time, "time", "s", {"t"}},
    {Quantity::position, "position", "m", {"x", "y", "z"}},
    {Quantity::contact_position, "contact_position", "m", {"px", "py", "pz"}},
    {Quantity::force, "force", "N", {"fx", "fy", "fz"}},
    {Quantity::torque, "torque", "Nm", {"tx", "ty", "tz"}},
    {Quantity::orientation, "orientation", "rad", {"qw", "qx", "qy", "qz"}},
    {Quantity::contact, "contact", "1", {"contact"}},
}};

void add_vectors(TrajectoryColumns& set, const std::array<std::string_view, 3>& names,
                 const std::vector<Vec3>& vectors) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    TrajectoryColumn column{std::string(names[static_cast<std::size_t>(axis)]), {}};
    column.values.reserve(vectors.size());
    for (const Vec3& v : vectors) column.values.push_back(v[axis]);
    set.columns.push_back(std::move(column));
  }
}

}  // namespace

const std::vector<double>* TrajectoryColumns::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(columns, name, &TrajectoryColumn::name);
  return found == columns.end() ? nullptr : &found->values;
}

std::size_t TrajectoryColumns::rows() const noexcept {
  std::size_t rows = 0;
  for (const TrajectoryColumn& column : columns) rows = std::max(rows, column.values.size());
  return rows;
}

std::size_t ComparedQuantity::size() const noexcept {
  return static_cast<std::size_t>(std::ranges::find(columns, std::string_view{}) - columns.begin());
}

const std::array<ComparedQuantity, 7>& compared_quantities() noexcept { return groups; }

const ComparedQuantity& compared_quantity(Quantity id) noexcept { return groups[static_cast<std::size_t>(id)]; }

const ComparedQuantity* quantity_of_column(std::string_view column) noexcept {
  for (const ComparedQuantity& group : groups) {
    if (!column.empty() && std::ranges::find(group.columns, column) != group.columns.end()) return &group;
  }
  return nullptr;
}

TrajectoryColumns columns_of(const recording::RenderedTrajectory& rendered, std::string source) {
  TrajectoryColumns set{std::move(source), {{"t", rendered.t_s}}};
  add_vectors(set, {"x", "y", "z"}, rendered.tip_W_m);
  add_vectors(set, {"fx", "fy", "fz"}, rendered.f_W_N);
  add_vectors(set, {"px", "py", "pz"}, rendered.contact_W_m);
  set.columns.push_back({"contact", {rendered.contact.begin(), rendered.contact.end()}});
  return set;
}

}  // namespace touchstone::golden
