// Against ordinary least squares where every row is a cluster of equal weight, and by how often its intervals hold the
// truth where a few clusters carry nearly all information.
#include "clustered_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"
#include "harness/stats/distributions.h"

namespace touchstone::acquisition {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

NormalEquations rows(const MatrixXd& x, const VectorXd& y) { return {x.transpose() * x, x.transpose() * y}; }

TEST(ClusteredFit, TheMeanOfSingleRowsHasTheStandardErrorOfTheMean) {
  // Of n values alone: leverage 1 / n, so that CR2 is the unbiased variance over n, with n - 1 degrees of freedom.
  const VectorXd y = (VectorXd(5) << 1.0, 4.0, 2.0, 2.0, 6.0).finished();
  std::vector<NormalEquations> clusters;
  for (const double v : y) clusters.push_back(rows(MatrixXd::Ones(1, 1), VectorXd::Constant(1, v)));
  const ClusteredFit fit(clusters);
  ASSERT_TRUE(fit.determined());
  EXPECT_NEAR(fit.estimate()[0], 3.0, 1e-12);
  const auto error = fit.error_of(VectorXd::Ones(1));
  EXPECT_NEAR(error.sigma, std::sqrt((4.0 + 1.0 + 1.0 + 1.0 + 9.0) / 4.0 / 5.0), 1e-12);
  EXPECT_NEAR(error.degrees, 4.0, 1e-9);
}

TEST(ClusteredFit, DoesNotDependOnUnits) {
  Random random(5);
  std::vector<NormalEquations> plain, scaled;
  for (int g = 0; g < 12; ++g) {
    MatrixXd x(4, 2);
    VectorXd y(4);
    for (int i = 0; i < 4; ++i) {
      x.row(i) << 1.0, random.uniform(-1, 1);
      y[i] = random.normal();
    }
    plain.push_back(rows(x, y));
    x.col(1) *= 1e6;
    scaled.push_back(rows(x, y));
  }
  const auto a = ClusteredFit(plain).error_of(Vector2d(1.0, 0.3)),
             b = ClusteredFit(scaled).error_of(Vector2d(1.0, 0.3e6));
  EXPECT_NEAR(b.sigma, a.sigma, 1e-9 * a.sigma);
  EXPECT_NEAR(b.degrees, a.degrees, 1e-6 * a.degrees);
}

TEST(ClusteredFit, SaysWhatIsNotDetermined) {
  EXPECT_FALSE(ClusteredFit().determined());
  // Two columns that are one.
  EXPECT_FALSE(ClusteredFit({rows(MatrixXd::Ones(4, 2), VectorXd::Ones(4))}).determined());
}

// A line through 40 clusters of which a few near either end carry nearly all information, as the rebounds of taps do
// among a hand's slow motion. Errors are correlated within a cluster.
TEST(ClusteredFit, ItsIntervalsHoldTheTruthAtTheEndsOfALineToo) {
  Random random(77);
  constexpr int sessions = 1000;
  int held[2] = {0, 0}, held_by_normal[2] = {0, 0};
  for (int session = 0; session < sessions; ++session) {
    std::vector<NormalEquations> clusters;
    for (int g = 0; g < 40; ++g) {
      const double time = (g - 19.5) / 20.0, size = g < 4 || g >= 36 ? random.log_uniform(0.3, 3.0) : 0.03;
      const double common = random.normal();
      MatrixXd x(5, 2);
      VectorXd y(5);
      for (int i = 0; i < 5; ++i) {
        const double slope = size * (1.0 + 0.3 * random.normal());
        x.row(i) << slope, slope * time;
        y[i] = common + 0.5 * random.normal();  // the truth is zero
      }
      clusters.push_back(rows(x, y));
    }
    const ClusteredFit fit(clusters);
    const Vector2d at[2] = {{1.0, 0.0}, {1.0, 1.0}};  // middle, end
    for (int k = 0; k < 2; ++k) {
      const auto error = fit.error_of(at[k]);
      const double miss = std::abs(at[k].dot(fit.estimate()));
      held[k] += miss < stats::student_t_975(error.degrees) * error.sigma;
      held_by_normal[k] += miss < 1.96 * error.sigma;
    }
  }
  for (int k = 0; k < 2; ++k) {
    EXPECT_GT(held[k], 935) << k;
    EXPECT_LT(held[k], 990) << k;  // with so few that carry it all, on the safe side
  }
  EXPECT_LT(held_by_normal[1], 915) << "the degrees of freedom matter";
}

}  // namespace
}  // namespace touchstone::acquisition
