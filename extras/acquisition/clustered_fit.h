// Least squares over clusters of rows: errors may be correlated in any way within a cluster, not between clusters.
//   The sandwich of scores alone (sandwich.h) is too small if few clusters hold most of the information: least squares
// bends the estimate towards those, so that their residuals are smaller than their errors. Here each cluster's score is
// enlarged by what its leverage took off, and Student's t has the degrees of freedom that the spread of the information
// over the clusters leaves, separately for each linear combination of the parameters: a few near the ends of a line,
// where a few clusters carry it, many in its middle. Both are exact in expectation if the errors have one variance
// and are independent.
// Source: Bell and McCaffrey, Bias reduction in standard errors for linear regression with multi-stage samples, Survey
// Methodology 28 (2002), 169-181: "CR2", and Satterthwaite's degrees of freedom (Biometrics Bulletin 2, 1946); in the
// form for any working model by Pustejovsky and Tipton, J. Business & Economic Statistics 36 (2018), 672-683.
//   With A = sum A_g, A_g = X_g^T X_g, B_g = A^-1/2 A_g A^-1/2 and the score s_g = X_g^T e_g, the variance of c^T b is
// sum_g (c^T M_g s_g)^2, M_g = A^-1/2 (1 - B_g)^-1/2 A^-1/2. All in the dimension of the parameters, since
// X_g^T f(X_g A^-1 X_g^T) = A^1/2 f(B_g) A^-1/2 X_g^T for every function f.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace touchstone::acquisition {

// X^T X and X^T y over the rows of one cluster, weights already in them.
struct NormalEquations {
  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
};

class ClusteredFit {
 public:
  ClusteredFit() = default;
  // All clusters have the same parameters. Without clusters, or if they do not determine every parameter, determined()
  // is false and nothing else may be asked.
  explicit ClusteredFit(std::vector<NormalEquations> clusters);

  [[nodiscard]] bool determined() const { return determined_; }
  [[nodiscard]] const Eigen::VectorXd& estimate() const { return estimate_; }
  // (X^T X)^-1 over all clusters: the covariance if errors were independent with unit variance.
  [[nodiscard]] const Eigen::MatrixXd& inverse_normal() const { return inverse_; }

  struct Error {
    double sigma = 0.0;    // standard error of contrast^T estimate()
    double degrees = 1.0;  // of freedom of Student's t, at least 1
  };
  [[nodiscard]] Error error_of(const Eigen::VectorXd& contrast) const;

 private:
  struct Cluster {
    Eigen::MatrixXd normal, enlarged;  // A_g, M_g
    Eigen::VectorXd score;             // s_g
  };
  std::vector<Cluster> clusters_;
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd estimate_;
  bool determined_ = false;
};

}  // namespace touchstone::acquisition
