// The just-noticeable-difference filter (eq 12; Hinterseer et al. 2008): a sample replaces the one held before only
// when the change can be felt. A continuous stimulus becomes a sparse staircase (figure 6 of the paper).
//
// Invariants: filtering twice changes nothing; every output value is an input value or 0 (not felt); the output differs
// from the input by at most the just noticeable difference of the held value, or the absolute threshold.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "harness/perception/filters/weber_law.h"

namespace touchstone::perception {

struct SparseSeries {
  std::vector<double> held;       // one value per input sample
  std::vector<std::size_t> kept;  // where it changes, ascending; the first is 0

  // Share of the samples that need not be kept, 0..1.
  [[nodiscard]] double reduction() const noexcept {
    return held.empty() ? 0.0 : 1.0 - static_cast<double>(kept.size()) / static_cast<double>(held.size());
  }
};

// A stimulus with its own law: K follows the held value. Below the absolute threshold nothing is felt: the output is 0.
SparseSeries dead_band(std::span<const double> stimulus, const WeberLaw& law);

// Displacement "likewise" (section 3.2): relative to the held displacement, with the K that the force of the moment
// has. The paper gives displacement no absolute threshold; `absolute_threshold_m` is the caller's choice, 0 for none.
// Throws BadData unless there is one displacement for each force.
SparseSeries displacement_dead_band(std::span<const double> displacement_m, std::span<const double> force_N,
                                    const WeberLaw& force_law, double absolute_threshold_m);

}  // namespace touchstone::perception
