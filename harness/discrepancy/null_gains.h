// What a candidate gains where nothing is missing: the bar that its gain on the data must exceed.
#pragma once

#include <functional>

#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/model_edit.h"

namespace touchstone {

struct NullCase {
  const Evidence* train = nullptr;
  const Evidence* holdout = nullptr;
  const FitData* train_blocks = nullptr;
  const FitData* holdout_blocks = nullptr;
  const Model* model = nullptr;  // the truth of the null worlds
  const std::vector<FreeParameter>* parameters = nullptr;
  int iterations = 12;
};

// How the candidate enters a fit of that model to that recording.
using CandidateOptions = std::function<CandidateFit(const Model&, const Recording&)>;

// The candidate's gains of held-out chi-squared in the worlds from `first` to before `last` where the case's model is
// the truth, under the declared noise and error of the mesh alone (parametric bootstrap, Efron and Tibshirani 1993,
// chapter 6.5).
std::vector<double> null_gains(const NullCase& null, const CandidateOptions& options, std::size_t first,
                               std::size_t last);

// Mean and so many standard deviations: worlds are too few for a far quantile. 0 for fewer than two.
double bar_above(const std::vector<double>& gains, double deviations);

}  // namespace touchstone
