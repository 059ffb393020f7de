// Joint fit of base parameters and effects to the blocks of a recording: weighted least squares over whitened blocks,
// robust against blocks that no noise explains (Huber 1964), within physical bounds (Ceres, Levenberg-Marquardt).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/discrepancy/free_parameter.h"
#include "harness/discrepancy/residual_blocks.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// A recording as the fit sees it. The referenced predictor must outlive it.
struct FitData {
  Predictor* predictor = nullptr;
  std::vector<ResidualBlock> blocks;
  std::vector<Vec3> measured_N;  // block means
  std::vector<BlockNoise> noise;
};

// Sum over blocks of Huber's rho of the whitened residual, in units of chi-squared.
double chi_squared(const FitData& data, const Model& model);
// The same by block.
std::vector<double> block_chi_squared(const FitData& data, const Model& model);

struct JointFit {
  Model model;
  double chi_squared = 0.0;
  Eigen::VectorXd u;  // of the free parameters
  // Of u, by runs of neighbouring blocks, which share what the model lacks (stats/sandwich.h);
  // never less than the curvature at the minimum gives.
  Eigen::MatrixXd covariance;
  std::vector<bool> at_bound;
  bool ok = false;  // finite, and the curvature could be inverted
};

// Of the free parameters' u at the model: the squares and products of the whitened residuals' derivatives. Empty if the
// model cannot run there.
Eigen::MatrixXd information_matrix(const FitData& data, const Model& model,
                                   const std::vector<FreeParameter>& parameters);

// Starts from the values in `start`. `iterations`: at most.
JointFit fit_jointly(const FitData& data, const Model& start, const std::vector<FreeParameter>& parameters,
                     int iterations, bool with_covariance);

}  // namespace touchstone::discrepancy
