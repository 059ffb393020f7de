// A response as a linear difference equation, by least squares (an ARX model: Ljung, System Identification, 2nd ed.
// 1999, section 4.2):  f_i = sum_j a_j f_(i-1-j) + sum_j b_j s_(i-L-j) + c, with a dead time of L samples.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace touchstone::renderer_faults {

struct Arx {
  int dead = 0;  // L
  Eigen::VectorXd a, b;
  double left = 1.0;  // of the variance of f

  // After a step of s, until f has come to within a hundred thousandth of what it becomes; 2000 at most beyond L.
  [[nodiscard]] int settling_samples() const;
  // By which a slow change is late.
  [[nodiscard]] double delay_samples() const;
};

// The simplest that leaves less than a thousandth of the variance of f from sample `from` on, where f is positive:
// first order with ever longer dead times, second order, a mean over 24 samples. Nothing if none does, or samples are
// few. `from` is at least 24.
std::optional<Arx> simplest_arx(const std::vector<double>& f, const std::vector<double>& s, std::size_t from);

}  // namespace touchstone::renderer_faults
