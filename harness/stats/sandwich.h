// How well an estimate is determined when its model is not quite right and neighbouring samples are not independent.
//
// An estimate that minimises a sum of losses has the covariance H^-1 (sum_c g_c g_c^T) H^-1, where H is the Hessian of
// the sum and g_c the gradient of the part of the sum that falls into cluster c. Clusters must be so long that they are
// independent; within a cluster, residuals may be correlated in any way.
// Source: Huber, The behavior of maximum likelihood estimates under nonstandard conditions, 5th Berkeley Symposium
// (1967); with clusters: Liang and Zeger, Longitudinal data analysis using generalized linear models, Biometrika 73
// (1986).
#pragma once

#include <Eigen/Core>

namespace touchstone::stats {

// `inverse_hessian`: n x n. `gradients`: a row for each cluster, n columns, in the same units of the loss. For centred
// gradients of B clusters multiply by B / (B - 1). The covariance is in the parameters' units, squared.
Eigen::MatrixXd sandwich_covariance(const Eigen::MatrixXd& inverse_hessian, const Eigen::MatrixXd& gradients);

// Gradients for sandwich_covariance where the parts of the sum follow each other in time and are correlated over a time
// that nobody knows (drift, 1/f noise, what a model lacks): the products of the rows add up to the covariance of the
// sum of `scores` (a row for each part), from the lowest 0.4 T^(2/3) cosine frequencies of T parts. Their number is
// that of degrees of freedom; a mean of the scores other than zero has no part in it. Source: Lazarus, Lewis, Stock and
// Watson, HAR inference: recommendations for practice, J. Business and Economic Statistics 36 (2018), equations 9 and
// 10; equal-weighted cosine: Mueller, J. Econometrics 141 (2007).
Eigen::MatrixXd long_run_gradients(const Eigen::MatrixXd& scores);

}  // namespace touchstone::stats
