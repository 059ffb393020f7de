// How far a model that lacks something is off, beyond noise. While an effect is missing, the declared noise alone gives
// blocks of light contact, whose noise is small, all the weight, and the first steps of a search would follow the
// misfit's accidents there. A variance for what the model lacks, one for each group of residuals (free air, along the
// normal, in the tangent plane), is added to the declared one, so large that every group's chi-squared comes to its
// degrees of freedom: Mandel and Paule 1970, equation 5; DerSimonian and Laird 1986. It is zero once the model leaves
// no more than the noise.
#pragma once

#include <vector>

#include "harness/discrepancy/joint_fit.h"

namespace touchstone::discrepancy {

// Standard deviations per axis [N].
struct Misfit {
  double free_N = 0.0;
  double along_normal_N = 0.0;
  double tangential_N = 0.0;
};

Misfit estimate_misfit(const FitData& declared, const rendering::Model& model);
// -2 ln likelihood of the blocks, less a constant, under noise and misfit. Unlike chi-squared it may be compared
// between models that leave different misfit.
double deviance(const FitData& data, const rendering::Model& model);
// The same block by block.
std::vector<double> block_deviance(const FitData& data, const rendering::Model& model);
void add_misfit(FitData& data, const Misfit& misfit);

}  // namespace touchstone::discrepancy
