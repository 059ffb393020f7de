#include "harness/recording_checks/force_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/stats/quantile.h"

namespace touchstone::recording_checks {

double force_noise_N(std::span<const Vec3> forces) {
  constexpr std::size_t fewest = 16;
  const double norm = std::sqrt(70.0);  // of the coefficients 1, -4, 6, -4, 1
  if (forces.size() < fewest) return 0.0;
  double largest = 0.0;
  std::vector<double> differences(forces.size() - 4);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < differences.size(); ++i) {
      differences[i] = std::abs(forces[i][axis] - 4.0 * forces[i + 1][axis] + 6.0 * forces[i + 2][axis] -
                                4.0 * forces[i + 3][axis] + forces[i + 4][axis]);
    }
    largest = std::max(largest, stats::normal_sigma_per_median * stats::upper_median(differences) / norm);
  }
  return largest;
}

}  // namespace touchstone::recording_checks
