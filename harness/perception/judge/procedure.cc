#include "harness/perception/judge/procedure.h"

#include <cmath>
#include <numbers>

#include "harness/stats/distributions.h"

namespace touchstone::perception {
namespace {

// The integral above by the trapezium rule, which converges faster than any power of the step for such integrands.
double share_right_of(double d_prime, int alternatives) {
  constexpr double reach = 9.0;
  constexpr int steps = 600;
  constexpr double step = 2.0 * reach / steps;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double z = -reach + step * i;
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    sum += density * std::pow(stats::normal_cdf(z + d_prime), alternatives - 1);
  }
  return sum * step;
}

}  // namespace

double d_prime_of_one_interval(double share_right) { return 2.0 * stats::normal_quantile(share_right); }

double d_prime_of_forced_choice(double share_right, int alternatives) {
  if (alternatives == 2) return share_right > 0.5 ? std::numbers::sqrt2 * stats::normal_quantile(share_right) : 0.0;
  double low = 0.0;
  double high = 10.0;
  constexpr int halvings = 60;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (share_right_of(middle, alternatives) < share_right ? low : high) = middle;
  }
  return low;
}

}  // namespace touchstone::perception
