#include "harness/base/least_squares.h"

#include <Eigen/Cholesky>

namespace touchstone {

LeastSquares::LeastSquares(const Eigen::MatrixXd& a) : decomposition_(a) {}

Eigen::Index LeastSquares::rank() const { return decomposition_.rank(); }

Eigen::MatrixXd LeastSquares::solve(const Eigen::MatrixXd& b) const { return decomposition_.solve(b); }

Eigen::MatrixXd LeastSquares::range() const {
  return decomposition_.householderQ() * Eigen::MatrixXd::Identity(decomposition_.rows(), rank());
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& n, const Eigen::VectorXd& r) { return n.ldlt().solve(r); }

}  // namespace touchstone
