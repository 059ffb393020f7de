// Contact events of a golden and an obtained run, and the band of golden values around each that a time tube allows.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace touchstone::golden {

// Rows at which the contact state differs from the row before.
std::vector<std::size_t> contact_changes(std::span<const double> contact);

// For every row the rows [first, last] of the golden within `tube_s` of a golden event near that row, {row, row}
// elsewhere. `t_s` ascending.
class TimeTube {
 public:
  TimeTube(std::span<const double> t_s, std::span<const double> contact, double tube_s);
  [[nodiscard]] std::pair<std::size_t, std::size_t> rows(std::size_t row) const noexcept;

 private:
  std::vector<std::pair<std::size_t, std::size_t>> around_;  // per row; empty without a tube
};

}  // namespace touchstone::golden
