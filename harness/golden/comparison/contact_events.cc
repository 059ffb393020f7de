#include "harness/golden/comparison/contact_events.h"

#include <algorithm>

namespace touchstone::golden {

std::vector<std::size_t> contact_changes(std::span<const double> contact) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < contact.size(); ++i) {
    if (contact[i] != contact[i - 1]) rows.push_back(i);
  }
  return rows;
}

TimeTube::TimeTube(std::span<const double> t_s, std::span<const double> contact, double tube_s) {
  if (!(tube_s > 0.0)) return;
  around_.resize(t_s.size());
  for (std::size_t i = 0; i < around_.size(); ++i) around_[i] = {i, i};
  const auto row_at = [&](double t) {
    return static_cast<std::size_t>(std::ranges::lower_bound(t_s, t) - t_s.begin());
  };
  for (const std::size_t event : contact_changes(contact)) {
    // Rows whose own tube reaches the event; the golden may be read as far as one tube from each.
    const std::size_t end = std::min(row_at(t_s[event] + tube_s) + 1, t_s.size());
    for (std::size_t i = row_at(t_s[event] - tube_s); i < end; ++i) {
      const std::size_t first = row_at(t_s[i] - tube_s);
      const std::size_t last = std::min(row_at(t_s[i] + tube_s), t_s.size() - 1);
      around_[i] = {std::min(first, i), std::max(last, i)};
    }
  }
}

std::pair<std::size_t, std::size_t> TimeTube::rows(std::size_t row) const noexcept {
  return around_.empty() ? std::pair{row, row} : around_[row];
}

}  // namespace touchstone::golden
