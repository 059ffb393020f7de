// Where the level of a series of builds changes, and where it drifts, at a false-alarm rate that is stated and holds
// however often one looks.
//
// A change of level is a pair (index, end): the mean of the values since the last change, up to `index`, differs from
// that of [index, end). Candidates are the pair of largest energy (E-divisive, energy.h, as in Apache Otava) and the
// pair of smallest p; [index, end) holds one of 24 numbers of values from 3 to 645, three to the factor two. A
// candidate counts if Student's t test (two_sample.h) falls below a level that is fixed beforehand, and below ten times
// of it with any `outliers` values of either side left out:
//
//   level = 0.9 rate / (365 * 24)
//
// 365 * 24 is the number of pairs whose end lies within one year of daily builds. A pair's test does not depend on
// the day on which it is looked at, so the sum over all pairs of the year bounds the probability of a false alarm
// (union bound): for independent normal noise at most `rate` a year, for the two kinds of change together. The other
// tenth of the rate is for drift: Mann and Kendall's test (trend.h) once a day, at 0.1 rate / 365. Other noise (heavy
// tails, outliers, correlation) is in the simulation of false_alarms_nightly_test.cc. The step stands where two levels
// fit the values of its pair best.
//
// A series in which at least seven of eight neighbours agree to the last bits is exact (a deterministic metric): there
// every difference beyond the smallest that matters is a change, from the first build on. The rate is about the others.
//
// Where a straight line describes a stretch better than levels, the stretch is a drift; steps are then searched for in
// what the line leaves, and as a staircase whose steps may be too small to be found one by one (staircase.h): the test
// of the trend has found that something changes, and only its form is chosen.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace touchstone::change_points {

struct ChangeOptions {
  double false_alarms_per_year = 0.01;  // of one series of daily builds, steps and drift together
  std::size_t outliers = 2;             // values that alone never make a change of level
  double smallest_relative = 1e-6;      // changes below this fraction of the level before do not matter
  double smallest_absolute = 1e-12;     // and neither do those below this, in the unit of the values
};

enum class ChangeKind : unsigned char { step, drift };

struct Change {
  ChangeKind kind = ChangeKind::step;
  std::size_t index = 0;  // step: first value of the new level; drift: first value of the stretch
  std::size_t first = 0;  // the change came with one of the values first..last: for a step those that fit nearly as
  std::size_t last = 0;   // well as `index` (95 %), for a drift the whole stretch
  double before = 0.0;    // step: mean of the neighbouring levels; drift: the line at both ends of the stretch
  double after = 0.0;
  double p = 1.0;  // of a staircase that was found by its trend: the trend's, for every step of it
};

struct Level {
  std::size_t first = 0;
  std::size_t end = 0;
  double from = 0.0;  // its value at `first`; differs from `to` only in a drift
  double to = 0.0;    // and at end - 1
};

struct ChangeReport {
  std::vector<Change> changes;  // by index
  std::vector<Level> levels;    // they cover the series
  bool exact = false;
};

// The values must be finite, oldest first.
ChangeReport find_changes(std::span<const double> values, const ChangeOptions& options = {});

}  // namespace touchstone::change_points
