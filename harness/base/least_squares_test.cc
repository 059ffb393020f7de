#include "harness/base/least_squares.h"

#include <gtest/gtest.h>

namespace touchstone {
namespace {

// The line through (0, 1), (1, 3), (2, 4), (3, 4) is 1.5 + x, by hand: sums 6, 14, 12, 23.
TEST(LeastSquares, FitsALine) {
  Eigen::MatrixXd a(4, 2);
  a << 1, 0, 1, 1, 1, 2, 1, 3;
  const LeastSquares fit(a);
  EXPECT_EQ(fit.rank(), 2);
  const Eigen::MatrixXd x = fit.solve(Eigen::Vector4d(1, 3, 4, 4));
  EXPECT_NEAR(x(0, 0), 1.5, 1e-14);
  EXPECT_NEAR(x(1, 0), 1.0, 1e-14);
}

// Of all x with 3 x0 + 4 x1 = 25 the one closest to the origin is (3, 4).
TEST(LeastSquares, IsTheShortestWhereColumnsDepend) {
  Eigen::MatrixXd a(2, 2);
  a << 3, 4, 6, 8;
  const LeastSquares fit(a);
  EXPECT_EQ(fit.rank(), 1);
  const Eigen::MatrixXd x = fit.solve(Eigen::Vector2d(25, 50));
  EXPECT_NEAR(x(0, 0), 3.0, 1e-14);
  EXPECT_NEAR(x(1, 0), 4.0, 1e-14);
}

TEST(LeastSquares, RangeSpansTheColumnsAndNoMore) {
  Eigen::MatrixXd a(5, 3);
  a << 1, 2, 3, 0, 1, 1, 2, 0, 2, -1, 1, 0, 4, 4, 8;  // the third is the sum of the others
  const Eigen::MatrixXd q = LeastSquares(a).range();
  ASSERT_EQ(q.cols(), 2);
  EXPECT_LT((q.transpose() * q - Eigen::MatrixXd::Identity(2, 2)).norm(), 1e-14);
  EXPECT_LT((q * q.transpose() * a - a).norm(), 1e-13);
}

TEST(SolveSymmetric, GivesTheSolution) {
  Eigen::MatrixXd n(2, 2);
  n << 4, 1, 1, 3;
  const Eigen::VectorXd x = solve_symmetric(n, Eigen::Vector2d(1, 2));  // det 11
  EXPECT_NEAR(x[0], 1.0 / 11.0, 1e-15);
  EXPECT_NEAR(x[1], 7.0 / 11.0, 1e-15);
}

}  // namespace
}  // namespace touchstone
