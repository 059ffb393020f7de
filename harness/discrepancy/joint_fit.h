// Joint fit of base parameters and effects to the blocks of a recording: weighted least squares over whitened blocks,
// robust against blocks that no noise explains (Huber 1964), within physical bounds (Ceres, Levenberg-Marquardt).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "harness/discrepancy/free_parameter.h"
#include "harness/discrepancy/residual_blocks.h"
#include "harness/discrepancy/time_budget.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// A recording as the fit sees it. What is pointed to must outlive it.
struct FitData {
  rendering::Predictor* predictor = nullptr;
  TimeBudget* budget = nullptr;  // with which a fit ends where it is; nullptr: fits go on to their end
  std::vector<ResidualBlock> blocks;
  std::vector<Vec3> measured_N;  // block means
  std::vector<BlockNoise> noise;
};

// Of derivatives, in u: friction and contact make small kinks, and this is well above them.
inline constexpr double derivative_step = 2e-3;
// A fit ends when a step takes less than this share off chi-squared.
inline constexpr double least_decrease = 1e-5;
// Whether the search has run out of time; it is noted there.
bool time_is_up(const FitData& data);

// Sum over blocks of Huber's rho of the whitened residual, in units of chi-squared.
double chi_squared(const FitData& data, const rendering::Model& model);
// The same by block.
std::vector<double> block_chi_squared(const FitData& data, const rendering::Model& model);

struct JointFit {
  rendering::Model model;
  double chi_squared = 0.0;
  Eigen::VectorXd u;  // of the free parameters
  // Of u, by the long-run variance of the blocks' gradients, since they share what the model lacks
  // (stats/sandwich.h); never less than the curvature at the minimum gives.
  Eigen::MatrixXd covariance;
  std::vector<bool> at_bound;
  bool ok = false;  // finite, and the curvature could be inverted
};

// Of the free parameters' u at the model: the squares and products of the whitened residuals' derivatives. Empty if the
// model cannot run there.
Eigen::MatrixXd information_matrix(const FitData& data, const rendering::Model& model,
                                   const std::vector<FreeParameter>& parameters);

// Starts from the values in `start`. `iterations`: at most.
JointFit fit_jointly(const FitData& data, const rendering::Model& start, const std::vector<FreeParameter>& parameters,
                     int iterations, bool with_covariance);

// The same, given up where it will not come to `hopeless`: if the iterations that are left, each with the largest
// decrease of the last four steps, would end above it.
JointFit fit_jointly_below(double abandon_above, const FitData& data, const rendering::Model& start,
                           const std::vector<FreeParameter>& parameters, int iterations);

}  // namespace touchstone::discrepancy
