#include "harness/stats/sandwich.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::stats {

Eigen::MatrixXd sandwich_covariance(const Eigen::MatrixXd& inverse_hessian, const Eigen::MatrixXd& gradients) {
  return inverse_hessian * (gradients.transpose() * gradients) * inverse_hessian;
}

Eigen::MatrixXd long_run_gradients(const Eigen::MatrixXd& scores) {
  const auto parts = static_cast<double>(scores.rows());
  const auto frequencies =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::lround(0.4 * std::pow(parts, 2.0 / 3.0))));
  Eigen::MatrixXd cosines(frequencies, scores.rows());
  for (Eigen::Index j = 0; j < cosines.rows(); ++j) {
    for (Eigen::Index t = 0; t < cosines.cols(); ++t) {
      const double place = (static_cast<double>(t) + 0.5) / parts;
      cosines(j, t) = std::cos(std::numbers::pi * static_cast<double>(j + 1) * place);
    }
  }
  return std::sqrt(2.0 / static_cast<double>(frequencies)) * (cosines * scores);
}

}  // namespace touchstone::stats
