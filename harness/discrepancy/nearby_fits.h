// Fits of recordings that differ by noise alone end near each other, and so they share the derivatives at one of them:
// Newton's chord method (Kelley 1995, Iterative Methods for Linear and Nonlinear Equations, chapter 5) with the
// Gauss-Newton matrix, reweighted for Huber's loss at each step. A fit costs a prediction for each of a few steps
// instead of one for each parameter and step.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "harness/discrepancy/joint_fit.h"

namespace touchstone::discrepancy {

class NearbyFits {
 public:
  // `data`: their blocks and noise; what was measured there does not matter. `model`: where they begin. The referenced
  // must outlive it.
  NearbyFits(const FitData& data, const rendering::Model& model, const std::vector<FreeParameter>& parameters);

  // Whether the model can run and no coefficient of a field is free, whose prior is not in the shared derivatives.
  [[nodiscard]] bool usable() const { return usable_; }
  // `measured_N`: means of the blocks. `start`: the model, or one that differs in what is not free. Without covariance.
  // For many threads.
  [[nodiscard]] JointFit fit(const std::vector<Vec3>& measured_N, const rendering::Model& start, int steps) const;

 private:
  const FitData* data_;
  const std::vector<FreeParameter>* parameters_;
  Eigen::MatrixXd derivatives_;  // of the whitened residuals
  bool usable_ = false;
};

}  // namespace touchstone::discrepancy
