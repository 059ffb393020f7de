// Trajectories as named columns, the shape in which baselines are compared: nothing is dropped, nothing is checked
// away, so that a NaN, a missing or an extra column reaches the comparison. Values are SI whatever the file's units.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/units.h"
#include "harness/recording/trajectory.h"

namespace touchstone::golden {

struct TrajectoryColumn {
  std::string name;  // without its unit: "fx"
  std::vector<double> values;
};

struct TrajectoryColumns {
  std::string source;  // file or description, for messages
  std::vector<TrajectoryColumn> columns;

  [[nodiscard]] const std::vector<double>* find(std::string_view name) const noexcept;
  // Of the longest column.
  [[nodiscard]] std::size_t rows() const noexcept;
};

enum class Quantity { time, position, contact_position, force, torque, orientation, contact };

// Columns that belong together and are compared as one quantity.
struct ComparedQuantity {
  Quantity id;
  std::string_view name;                    // as in tolerance files: "force"
  std::string_view unit;                    // SI: "N"
  std::array<std::string_view, 4> columns;  // empty names behind the last
  [[nodiscard]] std::size_t size() const noexcept;
};

// In the order of Quantity.
const std::array<ComparedQuantity, 7>& compared_quantities() noexcept;
const ComparedQuantity& compared_quantity(Quantity id) noexcept;
// The group a column belongs to; nullptr when the name is not known.
const ComparedQuantity* quantity_of_column(std::string_view column) noexcept;

TrajectoryColumns columns_of(const recording::RenderedTrajectory& rendered, std::string source);

}  // namespace touchstone::golden
