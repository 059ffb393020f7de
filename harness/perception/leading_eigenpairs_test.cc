#include "harness/perception/leading_eigenpairs.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <numeric>

#include "harness/base/random.h"

namespace touchstone::perception {
namespace {

Eigen::MatrixXd rotated(const Eigen::VectorXd& values, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd any(values.size(), values.size());
  for (double& entry : any.reshaped()) entry = random.normal();
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ();
  return q * values.asDiagonal() * q.transpose();
}

TEST(LeadingEigenpairs, HoldTheShareAndAreThoseOfTheMatrix) {
  const Eigen::Index n = dense_up_to + 40;
  for (const double scale : {1e-6, 1.0, 1e6}) {
    // A few that matter over noise; one that decays slowly, so that many are needed; one of low rank.
    for (const char* kind : {"few", "many", "rank 3"}) {
      Eigen::VectorXd values(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = static_cast<double>(i);
        values[i] = scale * (kind[0] == 'f'   ? (i < 4 ? 100.0 / (1.0 + at) : 1e-2 / (1.0 + at))
                             : kind[0] == 'm' ? 1.0 / (1.0 + 0.01 * at)
                                              : (i < 3 ? 3.0 - at : 0.0));
      }
      const Eigen::MatrixXd matrix = rotated(values, 5);
      const EigenPairs found = leading_eigenpairs(matrix, 0.9);
      ASSERT_LE(found.values.size(), n);
      const Eigen::Index some = std::min<Eigen::Index>(3, found.values.size());
      EXPECT_GE(found.values.sum(), 0.9 * matrix.trace() * (1.0 - 1e-12)) << kind;
      for (Eigen::Index i = 0; i < found.values.size(); ++i)
        EXPECT_NEAR(found.values[i], values[i], 1e-11 * values[0]) << kind << " " << i;
      EXPECT_LT(
          (matrix * found.vectors.leftCols(some) - found.vectors.leftCols(some) * found.values.head(some).asDiagonal())
              .norm(),
          1e-10 * values[0])
          << kind;
      const Eigen::Index all = found.vectors.cols();
      EXPECT_LT((found.vectors.transpose() * found.vectors - Eigen::MatrixXd::Identity(all, all)).norm(), 1e-9) << kind;
      if (kind[0] == 'f') {
        EXPECT_LT(all, 100) << "a dense solver was not needed";
      }
    }
  }
}

TEST(LeadingEigenpairs, SmallAndZeroMatricesGiveAllPairs) {
  const Eigen::VectorXd values{{3.0, 2.0, 1.0}};
  EXPECT_LT((leading_eigenpairs(rotated(values, 2), 0.1).values - values).norm(), 1e-14);
  EXPECT_EQ(leading_eigenpairs(Eigen::MatrixXd::Zero(dense_up_to + 5, dense_up_to + 5), 0.9).values.size(),
            dense_up_to + 5);
}

}  // namespace
}  // namespace touchstone::perception
