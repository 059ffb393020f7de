// Is what rises or falls along a stretch a staircase rather than a straight line?
//
// The best staircase of two to five steps is the one of least squares over all places of its steps (segment
// neighbourhoods: Auger and Lawrence, Bulletin of Mathematical Biology 51 (1989); optimal partitioning: Jackson et al.,
// IEEE Signal Processing Letters 12 (2005)). No tread is shorter than a tenth of the stretch, nor than three values. It
// is held against the line of least squares by the ratio of likelihoods; the two are not nested, so that the ratio has
// no chi-squared distribution (Cox, Tests of separate families of hypotheses, 4th Berkeley Symposium, 1961), and what
// it must exceed comes from simulated lines:
//
//   n log(squares about the line / squares about k steps) / autocorrelation time > 4 + 5 k
//
// About one straight line in twenty passes, whatever its rise and the length of the stretch (staircase_test.cc
// simulates them). Of the numbers of steps that pass, the modified criterion of Zhang and Siegmund (Biometrics 63,
// 2007) chooses: 3 log n for each step, and log(length / n) for each tread. Values farther than four robust standard
// deviations from the median line count as if they lay there.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "change_points/trend.h"

namespace touchstone::change_points {

// The first value of each tread but the lowest; empty if a line explains the values as well. `trend` is theirs.
std::vector<std::size_t> find_staircase(std::span<const double> values, const Trend& trend);

}  // namespace touchstone::change_points
