#include "harness/discrepancy/whitened_regression.h"

#include <utility>

namespace touchstone::discrepancy {

Eigen::MatrixXd whiten_responses(const FitData& data, const std::vector<std::vector<Vec3>>& means) {
  Eigen::MatrixXd responses(static_cast<Eigen::Index>(3 * data.blocks.size()), static_cast<Eigen::Index>(means.size()));
  for (std::size_t c = 0; c < means.size(); ++c) {
    for (std::size_t b = 0; b < data.blocks.size(); ++b) {
      BlockNoise linear = data.noise[b];
      linear.bias_W_N.setZero();
      responses.block<3, 1>(static_cast<Eigen::Index>(3 * b), static_cast<Eigen::Index>(c)) =
          whitened(means[c][b], linear);
    }
  }
  return responses;
}

RegressionData whiten_for_regression(const FitData& data, const std::vector<Vec3>& measured_minus_predicted_N,
                                     const std::vector<std::vector<Vec3>>& series) {
  Eigen::VectorXd left(static_cast<Eigen::Index>(3 * data.blocks.size()));
  const auto residual = block_means(data.blocks, measured_minus_predicted_N);
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    left.segment<3>(static_cast<Eigen::Index>(3 * b)) = whitened(residual[b], data.noise[b]);
  }
  std::vector<std::vector<Vec3>> means;
  means.reserve(series.size());
  for (const auto& one : series) means.push_back(block_means(data.blocks, one));
  return {std::move(left), whiten_responses(data, means)};
}

RidgeRegression::RidgeRegression(const Eigen::MatrixXd& responses, double ridge)
    : responses_(&responses), size_(responses.colwise().norm().transpose().cwiseMax(1e-300)) {
  const Eigen::MatrixXd scaled = responses * size_.cwiseInverse().asDiagonal();
  Eigen::MatrixXd normal = scaled.transpose() * scaled;
  normal.diagonal().array() += ridge;
  normal_.compute(normal);
}

Eigen::VectorXd RidgeRegression::coefficients(const Eigen::VectorXd& residual) const {
  const Eigen::VectorXd products = size_.cwiseInverse().cwiseProduct(responses_->transpose() * residual);
  return size_.cwiseInverse().cwiseProduct(normal_.solve(products));
}

Eigen::VectorXd ridge_coefficients(const RegressionData& data, double ridge) {
  return RidgeRegression(data.responses, ridge).coefficients(data.residual);
}

double left_by(const RegressionData& data, const Eigen::VectorXd& coefficients) {
  return (data.residual - data.responses * coefficients).squaredNorm();
}

}  // namespace touchstone::discrepancy
