// 95 % intervals of what was fitted: parametric bootstrap of the case itself (Efron and Tibshirani 1993, chapter 6.5).
// In every null world, where the found model is the truth under the declared noise and error of the mesh, the fit is
// made again; how far it lands from the truth, on average and in spread, is what the stated value may be off. So the
// error of the mesh, one and the same in all blocks, and the bias that noise in the positions brings about are in the
// interval. The bias is not taken off, since its sign depends on the path that the simulation assumes to be the true
// one, and since the model with it taken off predicts worse from noisy positions: its size widens the interval to both
// sides (JCGM 100:2008, Guide to the expression of uncertainty in measurement, F.2.4.5), and further to the side that
// the truth is on where noise weakens a value by a share of itself (attenuation: Fuller 1987, equation 1.1.7). Where
// the model leaves more than simulations do, bias and variance are as much larger in square as what it leaves: both go
// with the variance of the noise (Birge 1932, Phys. Rev. 40:207; attenuation: Fuller 1987), of which a maker's word is
// no more than that. Where the fit's own covariance (stats/sandwich.h) is wider it counts instead.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/discrepancy/evidence.h"

namespace touchstone::discrepancy {

// The fit made again in a null world.
struct NullFit {
  std::size_t world = 0;
  rendering::Model model;
  double chi_squared = 0.0;  // that it leaves there
};

// Fewer say nothing of how far fits scatter.
inline constexpr std::size_t fewest_draws = 3;

// Sets in the model what is not fitted but read from the forces alone, as far off as it may be: another draw for every
// world.
using ReadValues = std::function<void(rendering::Model&, std::size_t world)>;

// In each null world where the fit succeeds. `data`: the blocks of `train` that `fit` was made on. `read`, where given,
// goes before the fit.
std::vector<NullFit> bootstrap_fits(const Evidence& train, const FitData& data, const JointFit& fit,
                                    const std::vector<FreeParameter>& parameters, int iterations,
                                    const ReadValues& read = {});

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// How much more, in square, the fit leaves than the draws do under the same weights: 1 or more. While something is
// missing that is not noise, so that a search does not go by it.
double excess_over(const std::vector<NullFit>& draws, const JointFit& fit);

// Of an effect's parameter, holding its fitted value; of no width where nothing free moves it. `fit` with covariance.
Interval interval95(const JointFit& fit, const std::vector<FreeParameter>& parameters,
                    const std::vector<NullFit>& draws, const std::string& effect, const std::string& name,
                    double excess = 1.0);

// The least size that a parameter may have, 95 %; 0 where its sign is not sure. Without draws by the covariance alone.
double least_size95(const JointFit& fit, const std::vector<FreeParameter>& parameters,
                    const std::vector<NullFit>& draws, const std::string& effect, const std::string& name);

}  // namespace touchstone::discrepancy
