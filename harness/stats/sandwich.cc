#include "harness/stats/sandwich.h"

namespace touchstone::stats {

Eigen::MatrixXd sandwich_covariance(const Eigen::MatrixXd& inverse_hessian, const Eigen::MatrixXd& gradients) {
  return inverse_hessian * (gradients.transpose() * gradients) * inverse_hessian;
}

}  // namespace touchstone::stats
