// What a candidate gains where nothing is missing: the bar that its gain on the data must exceed.
#pragma once

#include <functional>

#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/model_edit.h"

namespace touchstone::discrepancy {

struct NullCase {
  const Evidence* train = nullptr;
  const Evidence* validation = nullptr;
  const FitData* train_blocks = nullptr;
  const FitData* validation_blocks = nullptr;
  const rendering::Model* model = nullptr;  // the truth of the null recordings
  const std::vector<FreeParameter>* parameters = nullptr;
  int iterations = 12;
};

// Fits of a world's recording with what competes added to `base`, which was fitted to it.
using RefitInWorld = std::function<std::vector<JointFit>(const FitData& train, const recording::Recording& recording,
                                                         const rendering::Model& base)>;

// The most that any of the fits gains of validation chi-squared in each world from `first` to before `last`, where the
// case's model is the truth, under the declared noise and error of the mesh alone (parametric bootstrap, Efron and
// Tibshirani 1993, chapter 6.5; of several that compete the maximum, Westfall and Young 1993).
std::vector<double> null_gains(const NullCase& null, const RefitInWorld& refits, std::size_t first, std::size_t last);

// The first few simulated recordings, which settle a gain that is three times the bar that they make, or a third of it
// (a test that stops as soon as it is clear: Besag and Clifford 1991); all are asked about any other.
constexpr std::size_t few_worlds = 4;
inline bool is_clear(double gain, double bar) {
  constexpr double near = 3.0;
  return gain > near * bar || near * gain < bar;
}

// Mean plus N standard deviations: the recordings are too few for a far quantile. 0 for fewer than two.
double bar_above(const std::vector<double>& gains, double deviations);

}  // namespace touchstone::discrepancy
