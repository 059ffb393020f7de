// 95 % intervals of what was fitted: parametric bootstrap of the case itself (Efron and Tibshirani 1993, chapter 6.5).
// In every null world, where the found model is the truth under the declared noise and error of the mesh, the fit is
// made again; how far fits spread is what the stated value may be off. So the error of the mesh, one and the same in
// all blocks, is in the interval. Where the fit's own covariance (stats/sandwich.h) is wider it counts instead.
// Noise in the positions draws a value away from the truth. By how much is asked of the data themselves and of no
// assumed path: the fit is made again at positions with the tracker's noise added once more, and what that changes is
// extrapolated to positions without any (SIMEX: Cook and Stefanski 1994, J. Am. Stat. Assoc. 89:1314), by their
// rational extrapolant, which is exact for attenuation (Fuller 1987, equation 1.1.7), where noise weakens a value, else
// along a line. The value stays, since the one without noise predicts worse from noisy positions; the interval holds
// both and what each may be off. Where the model leaves more than simulations do, the noise is as much larger in square
// (Birge 1932, Phys. Rev. 40:207), of which a maker's word is no more than that.
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

// The fits at noisier positions, where they succeed.
std::vector<rendering::Model> noisier_fits(const Evidence& train, const FitData& data, const JointFit& fit,
                                           const std::vector<FreeParameter>& parameters, int iterations);

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
                    double excess = 1.0, const std::vector<rendering::Model>& noisier = {});

// The least size that a parameter may have, 95 %; 0 where its sign is not sure. Without draws by the covariance alone.
double least_size95(const JointFit& fit, const std::vector<FreeParameter>& parameters,
                    const std::vector<NullFit>& draws, const std::string& effect, const std::string& name);

}  // namespace touchstone::discrepancy
