// Two explanations compared on the smoothed trajectory, without the tracker's noise.
//
// At noisy positions a law may do well only because it passes less of the noise on: a soft law where depth hardly
// varies, a mass whose noisy acceleration cancels a spring's noisy depth, friction that turns slowly against viscosity.
// An effect acts along the true path. So what is named must help there; equal fits there are indistinguishable.
#pragma once

#include <optional>
#include <vector>

#include "harness/discrepancy/evidence.h"

namespace touchstone::discrepancy {

struct Explanation {
  const rendering::Model* model = nullptr;  // where its fit starts
  const std::vector<FreeParameter>* parameters = nullptr;
};

struct LikelyLoss {
  double lost = 0.0;     // of validation chi-squared, by `other` against `one`
  double error = 0.0;    // its standard error by runs of blocks
  double apart_N = 0.0;  // RMS of the forces' difference, on the validation blocks
};

// Both fitted again on the smoothed trajectory, under the blocks' noise as given. Nothing where a fit fails.
std::optional<LikelyLoss> compare_smoothed(const SearchData& data, FitData train, FitData validation,
                                           const Explanation& one, const Explanation& other, int iterations);

}  // namespace touchstone::discrepancy
