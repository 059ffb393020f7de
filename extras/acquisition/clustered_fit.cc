#include "clustered_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

namespace touchstone::acquisition {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the largest eigenvalue of normal equations whose columns have unit length.
constexpr double singular = 1e-12;
// 1 - leverage. A cluster that alone determines a parameter has no residual there to enlarge.
constexpr double least_rest = 1e-9;

}  // namespace

ClusteredFit::ClusteredFit(std::vector<NormalEquations> clusters) {
  if (clusters.empty()) return;
  const auto size = clusters.front().right.size();
  MatrixXd normal = MatrixXd::Zero(size, size);
  VectorXd right = VectorXd::Zero(size);
  for (const NormalEquations& c : clusters) normal += c.normal, right += c.right;
  if (!(normal.diagonal().minCoeff() > 0.0) || !normal.allFinite() || !right.allFinite()) return;
  // Columns of unit length first: their units differ.
  const VectorXd unit = normal.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = unit.asDiagonal() * normal * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> all(scaled);
  if (all.info() != Eigen::Success || !(all.eigenvalues()[0] > singular * all.eigenvalues()[size - 1])) return;
  const MatrixXd root = all.operatorInverseSqrt();
  const MatrixXd whiten = root * unit.asDiagonal();  // W with W^T W = A^-1
  inverse_ = whiten.transpose() * whiten;
  estimate_ = inverse_ * right;
  clusters_.reserve(clusters.size());
  for (NormalEquations& c : clusters) {
    const MatrixXd whitened = whiten * c.normal * whiten.transpose();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> share(whitened);
    const VectorXd rest = (1.0 - share.eigenvalues().array()).max(least_rest).rsqrt();
    const MatrixXd enlarge = share.eigenvectors() * rest.asDiagonal() * share.eigenvectors().transpose();
    VectorXd score = c.right - c.normal * estimate_;
    clusters_.push_back({std::move(c.normal), whiten.transpose() * enlarge * whiten, std::move(score)});
  }
  determined_ = true;
}

ClusteredFit::Error ClusteredFit::error_of(const VectorXd& contrast) const {
  // Under the working model the covariance of two clusters' parts z_g = c^T M_g s_g is
  // m_g^T (A_g [g = h] - A_g A^-1 A_h) m_h, m_g = M_g c. Its trace and its squared norm in one pass.
  double variance = 0.0, trace = 0.0, square = 0.0;
  MatrixXd outer = MatrixXd::Zero(contrast.size(), contrast.size());
  for (const Cluster& c : clusters_) {
    const VectorXd m = c.enlarged * contrast, lever = c.normal * m;
    const double part = m.dot(c.score), own = m.dot(lever), taken = lever.dot(inverse_ * lever);
    variance += part * part;
    trace += own - taken;
    square += own * own - 2.0 * own * taken;
    outer += lever * lever.transpose();
  }
  const MatrixXd spread = inverse_ * outer;
  square += (spread * spread).trace();
  return {std::sqrt(variance), square > 0.0 ? std::max(1.0, trace * trace / square) : 1.0};
}

}  // namespace touchstone::acquisition
