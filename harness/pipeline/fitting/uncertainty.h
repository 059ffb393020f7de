// How well a fit determines its parameters, from the curvature of the loss and from how much its gradient scatters over
// parts of the recording. Neighbouring samples are not independent: gradients are summed in blocks of time much longer
// than the residuals remember.
// The covariance is stats::sandwich_covariance of the centred gradients of the blocks' sums, times B/(B - 1).
// Intervals: Student's t with B - n degrees of freedom, B blocks, n parameters.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace touchstone::pipeline {

// Loss of each sample at a point of the unit cube.
using LossFunction = std::function<std::vector<double>(const std::vector<double>&)>;

struct Uncertainty {
  bool known = false;
  std::string why_not;
  std::vector<double> low_u;  // 95 % interval of each parameter, within the unit cube
  std::vector<double> high_u;
  std::vector<double> sigma_u;
  std::size_t blocks = 0;
  double block_s = 0.0;
};

// `t_s`: time of each sample, increasing. Blocks end at gaps longer than ten median steps too.
Uncertainty sandwich_uncertainty(const LossFunction& loss, const std::vector<double>& best_u,
                                 const std::vector<double>& t_s);

// The blocks' first samples, and their length: 20 times the time in which the autocorrelation of the square root of
// `loss` about its mean falls below 1/e, but no more than a twentieth of the samples' time.
std::vector<std::size_t> independent_blocks(const std::vector<double>& loss, const std::vector<double>& t_s,
                                            double& block_s);

}  // namespace touchstone::pipeline
