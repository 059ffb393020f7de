// Joint fit of base parameters and effects to the blocks of a recording: weighted least squares over whitened blocks,
// robust against blocks that no noise explains (Huber 1964), within physical bounds (Ceres, Levenberg-Marquardt).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/discrepancy/free_parameter.h"
#include "harness/discrepancy/residual_blocks.h"
#include "harness/discrepancy/time_budget.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// A recording as the fit sees it. What is pointed to must outlive it.
struct FitData {
  Predictor* predictor = nullptr;
  TimeBudget* budget = nullptr;  // with which a fit ends where it is; nullptr: fits go on to their end
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

// The same, given up where it will not come to `hopeless`: if the iterations that are left, each with the largest
// decrease of the last four steps, would end above it.
JointFit fit_jointly_below(double hopeless, const FitData& data, const Model& start,
                           const std::vector<FreeParameter>& parameters, int iterations);

// Fits of recordings that differ by noise alone end near each other, and so they share the derivatives at one of them:
// Newton's chord method (Kelley 1995, Iterative Methods for Linear and Nonlinear Equations, chapter 5) with the
// Gauss-Newton matrix, reweighted for Huber's loss at each step. A fit costs a prediction for each of a few steps
// instead of one for each parameter and step.
class NearbyFits {
 public:
  // `data`: their blocks and noise; what was measured there does not matter. `model`: where they begin. The referenced
  // must outlive it.
  NearbyFits(const FitData& data, const Model& model, const std::vector<FreeParameter>& parameters);

  // Whether the model can run and no coefficient of a field is free, whose prior is not in the shared derivatives.
  [[nodiscard]] bool usable() const { return usable_; }
  // `measured_N`: means of the blocks. `start`: the model, or one that differs in what is not free. Without covariance.
  // For many threads.
  [[nodiscard]] JointFit fit(const std::vector<Vec3>& measured_N, const Model& start, int steps) const;

 private:
  const FitData* data_;
  const std::vector<FreeParameter>* parameters_;
  Eigen::MatrixXd derivatives_;  // of the whitened residuals
  bool usable_ = false;
};

}  // namespace touchstone::discrepancy
