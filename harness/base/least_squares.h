// Linear least squares of any size, dense, by Eigen. In one place, because the code of each of Eigen's decompositions
// takes seconds to compile in every unit that names it.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

namespace touchstone {

// min |A x - b| over x, and of all x that reach it the shortest one: by a complete orthogonal decomposition with column
// pivoting (Golub and Van Loan, Matrix Computations, section 5.5). A: m x n, m and n at least 1, finite.
class LeastSquares {
 public:
  explicit LeastSquares(const Eigen::MatrixXd& a);

  // How many columns of A are independent: pivots below the largest one times n roundings count as zero.
  [[nodiscard]] Eigen::Index rank() const;
  // x for each column of b: m x k to n x k.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  // m x rank(): orthonormal columns that span what A's columns span.
  [[nodiscard]] Eigen::MatrixXd range() const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition_;
};

// x of N x = r, of which only the lower triangle is looked at, for a symmetric positive semidefinite N, by its LDL'
// decomposition with pivoting (Eigen's LDLT).
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& n, const Eigen::VectorXd& r);

}  // namespace touchstone
