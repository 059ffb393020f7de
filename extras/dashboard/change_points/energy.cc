#include "change_points/energy.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::change_points {

EnergySplit largest_energy_split(std::span<const double> values, std::size_t smallest) {
  EnergySplit best;
  const std::size_t count = values.size();
  smallest = std::max<std::size_t>(smallest, 2);
  // within[k]: sum of the distances of all pairs among the first k values.
  std::vector<double> within(count + 1, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < k; ++i) sum += std::abs(values[i] - values[k]);
    within[k + 1] = within[k] + sum;
  }
  // to_left[j]: sum of the distances of value j to the first `index` values.
  std::vector<double> to_left(count, 0.0);
  for (std::size_t index = 1; index < count; ++index) {
    for (std::size_t j = index; j < count; ++j) to_left[j] += std::abs(values[index - 1] - values[j]);
    if (index < smallest) continue;
    const auto n = static_cast<double>(index);
    double between = 0.0;
    for (std::size_t end = index + 1; end <= count; ++end) {
      between += to_left[end - 1];
      if (end - index < smallest) continue;
      const auto m = static_cast<double>(end - index);
      const double right = within[end] - within[index] - between;
      const double energy = 2.0 / (n + m) * (between - m / (n - 1.0) * within[index] - n / (m - 1.0) * right);
      if (energy > best.energy) best = {index, end, energy};
    }
  }
  return best;
}

}  // namespace touchstone::change_points
