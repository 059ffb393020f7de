// Linear regression of whitened block residuals on given responses, fitted on one part and judged on another: the tool
// of tests that may detect but never join a model.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "harness/discrepancy/joint_fit.h"

namespace touchstone::discrepancy {

// Residuals of blocks and responses to them, whitened by the blocks' noise: 3 rows a block.
struct RegressionData {
  Eigen::VectorXd residual;
  Eigen::MatrixXd responses;  // one column each
};

// `series`: per response a force per sample [N].
RegressionData whiten_for_regression(const FitData& data, const std::vector<Vec3>& measured_minus_predicted_N,
                                     const std::vector<std::vector<Vec3>>& series);

// The responses alone, of means over the blocks.
Eigen::MatrixXd whiten_responses(const FitData& data, const std::vector<std::vector<Vec3>>& means);

// Ridge regression (Hoerl and Kennard 1970) with columns scaled to equal size; `ridge` relative to their squares.
// Factorized once for any number of residuals.
class RidgeRegression {
 public:
  // `responses` must outlive it.
  RidgeRegression(const Eigen::MatrixXd& responses, double ridge);
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& residual) const;

 private:
  const Eigen::MatrixXd* responses_;
  Eigen::VectorXd size_;
  Eigen::LDLT<Eigen::MatrixXd> normal_;
};
Eigen::VectorXd ridge_coefficients(const RegressionData& data, double ridge);

// Chi-squared left by the coefficients.
double left_by(const RegressionData& data, const Eigen::VectorXd& coefficients);

}  // namespace touchstone::discrepancy
